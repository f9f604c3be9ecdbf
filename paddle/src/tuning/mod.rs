//! Methods that find gains of the position regulator on a simulated paddle.

pub mod assessment;
pub mod core_response;
pub mod gains;
pub mod margins;
pub mod oscillation;
pub mod plant_response;
pub mod search;
pub mod specification;
pub mod spread;
pub mod trial;
pub mod ziegler_nichols;
