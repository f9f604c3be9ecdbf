//! Methods that find gains of the position regulator, on a simulated paddle.

pub mod gains;
pub mod oscillation;
pub mod trial;
pub mod ziegler_nichols;
