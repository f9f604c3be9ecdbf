//! Where a simulation and a device differ, which effect causes it, how far the gap shrinks.
//!
//! A [`Recording`] is what a device was told and where it went, with the [`Model`] whose gap is asked about: of any
//! single axis, rotary or linear, of any size. [`measure()`] gives the gap of a [`Device`] on it, [`diagnose`] tries every
//! [`Effect`] by simulation and says which ones close it on data that the fit has not seen.
//!
//! ```no_run
//! use gap::{Options, Recording, diagnose, inspected};
//!
//! let recording = inspected(Recording::read("my-recording")?)?;
//! let outcome = diagnose(&recording, &Options::default());
//! for effect in &outcome.diagnosis.effects {
//!     println!("{} closes {:.0} %", effect.name, 100.0 * effect.shrink);
//! }
//! // The model that closes it, as a file for later.
//! let file = gap::ModelFile::new(&outcome.model, &recording);
//! std::fs::write("corrected.toml", file.to_string())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/linear_axis.rs` makes a recording in memory and tries an effect by hand.

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
