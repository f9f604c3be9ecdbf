//! Where a simulation and a device differ, which effect causes it, how far the gap shrinks.

mod candidate;
mod diagnose;
pub mod diagnosis;
mod experiment;
mod fit;
mod hypothesis;
mod locate;
mod measure;
pub mod model_file;
mod motion;
mod noise;
pub mod predict;
pub mod restart;
mod select;
pub mod series;
mod whitening;

pub use diagnose::{CorrectedEffect, CorrectedModel, Options, Outcome, diagnose};
pub use measure::{Gap, PredictedRun, measure};
pub use model_file::ModelFile;
