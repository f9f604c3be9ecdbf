//! `paddle gap`: measures how far a simulation is from a recording, and why.

mod batch;
pub mod blind;
pub mod diagnose;
pub mod export;
pub mod fleet;
pub mod import;
pub mod init;
pub mod known;
pub mod look;
pub mod measure;
mod own_effects;
pub mod results;
mod simulator;
pub mod usable;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::Target;
use clap::Subcommand;

/// Subcommands of `paddle gap`.
#[derive(Subcommand)]
pub enum Command {
    /// Convert logs of other programs to a recording.
    Import(Box<import::Arguments>),
    /// Write a commented recording.toml for CSV files that already have the columns of the format.
    Init(Box<init::Arguments>),
    /// Measure the gap, and the floor: the gap that sensor noise and restarts alone would cause.
    Measure(measure::Arguments),
    /// Show the torque that the nominal model lacks, over the quantity on which it depends.
    Look(look::Arguments),
    /// Locate the gap, name the effect that causes it, and report how much the effect reduces it.
    Diagnose(diagnose::Arguments),
    /// Compare many diagnoses: list the effects per device, and how they change.
    Fleet(fleet::Arguments),
    /// Export a corrected model for a simulator (MuJoCo, URDF, USD, Simulink, Python), or as settings of the console.
    Export(export::Arguments),
    /// Score the diagnosis on recordings with hidden effects.
    Blind(blind::Arguments),
}

impl Command {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        match self {
            Self::Import(arguments) => arguments.targets(),
            Self::Init(arguments) => arguments.targets(),
            Self::Measure(arguments) => arguments.targets(),
            Self::Look(arguments) => arguments.targets(),
            Self::Diagnose(arguments) => arguments.targets(),
            Self::Fleet(_) => Vec::new(),
            Self::Export(arguments) => arguments.targets(),
            Self::Blind(arguments) => arguments.targets(),
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// Returns a [`Failure`] with the cause and a remedy.
    pub fn run(&self) -> Result<Answer, Failure> {
        match self {
            Self::Import(arguments) => import::run(arguments),
            Self::Init(arguments) => init::run(arguments),
            Self::Measure(arguments) => measure::run(arguments),
            Self::Look(arguments) => look::run(arguments),
            Self::Diagnose(arguments) => diagnose::run(arguments),
            Self::Fleet(arguments) => fleet::run(arguments),
            Self::Export(arguments) => export::run(arguments),
            Self::Blind(arguments) => blind::run(arguments),
        }
    }
}
