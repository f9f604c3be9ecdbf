//! Where a simulation and a device differ, which effect causes it, how far the gap shrinks.

mod measure;
mod noise;
pub mod predict;
pub mod restart;
pub mod series;

pub use measure::{Gap, PredictedRun, measure};
