//! `paddle gap`: how far a simulation is from a recording, and why.

mod batch;
pub mod blind;
pub mod diagnose;
pub mod measure;
pub mod results;

use crate::answer::Answer;
use crate::failure::Failure;
use ::gap::{Recording, inspected};
use clap::Subcommand;
use std::path::Path;

/// What can be asked of a recording.
#[derive(Subcommand)]
pub enum Command {
    /// Measure the gap, and the floor that sensor noise and restarts alone would leave.
    Measure(measure::Arguments),
    /// Say where the gap lies, which effect causes it, and how far it shrinks.
    Diagnose(diagnose::Arguments),
    /// Score the diagnosis on recordings with something hidden in them.
    Blind(blind::Arguments),
}

impl Command {
    /// Does it.
    ///
    /// # Errors
    /// [`Failure`] with cause and mend.
    pub fn run(&self) -> Result<Answer, Failure> {
        match self {
            Self::Measure(arguments) => measure::run(arguments),
            Self::Diagnose(arguments) => diagnose::run(arguments),
            Self::Blind(arguments) => blind::run(arguments),
        }
    }
}

/// Reads a recording whose columns mean what its model takes them for.
fn read(folder: &Path) -> Result<Recording, Failure> {
    inspected(Recording::read(folder)?).map_err(|mistake| Failure::Unit {
        folder: folder.to_owned(),
        mistake,
    })
}
