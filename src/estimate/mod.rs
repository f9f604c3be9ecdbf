//! Estimation: from sampled positions to a filtered position and a velocity.

pub mod biquad;
pub mod low_pass;
pub mod position_filter;
pub mod velocity;
