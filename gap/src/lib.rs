//! Shows where a simulation and a device differ, which effect causes it, and how far the gap shrinks.
//!
//! A [`Recording`] holds the input and the motion of a device, and the [`Model`] whose gap is to be explained. The device may be any
//! single axis, rotary or linear, of any size. [`measure()`] gives the gap of a [`Device`] on the recording. [`diagnose`] tries every
//! [`Effect`] by simulation, and returns the effects that close the gap on held-out data.

mod columns;
mod comparison;
mod diagnose;
pub mod diagnosis;
pub mod effects;
mod experiment;
mod fit;
mod floor;
mod guess;
mod instrument;
mod locate;
#[cfg(test)]
mod made;
mod measure;
pub mod missing_torque;
pub mod model_file;
mod model_free;
mod plausible;
pub mod predict;
mod ruler;
mod select;
mod shapley;
mod shrink;
mod stage;
mod tables;
mod term;
mod windows;

pub use diagnose::{CorrectedEffect, CorrectedModel, Options, Outcome, diagnose};
pub use host_sim::device::Device;
pub use host_sim::effects::Effect;
pub use instrument::{UnitMistake, inspected};
pub use measure::{Gap, PredictedRun, measure};
pub use missing_torque::MissingTorque;
pub use model_file::ModelFile;
pub use recording::{self, Model, Recording};
pub use stage::Stage;
pub use tables::{Tabulated, tabulated};
pub use windows::{restart, series};
