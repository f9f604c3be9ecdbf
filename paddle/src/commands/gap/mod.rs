//! `paddle gap`: how far a simulation is from a recording, and why.

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

/// What can be asked of a recording.
#[derive(Subcommand)]
pub enum Command {
    /// Make a recording of logs of other programs.
    Import(Box<import::Arguments>),
    /// Write a commented recording.toml for CSV files that are in the format.
    Init(Box<init::Arguments>),
    /// Measure the gap, and the floor that sensor noise and restarts alone would leave.
    Measure(measure::Arguments),
    /// Show the torque that the nominal model lacks, over the axis that carries it.
    Look(look::Arguments),
    /// Say where the gap lies, which effect causes it, and how far it shrinks.
    Diagnose(diagnose::Arguments),
    /// Say what many diagnoses have in common: which effect on which device, and how it changes.
    Fleet(fleet::Arguments),
    /// Write a corrected model for a simulator: MuJoCo, URDF, USD, Simulink, Python; or as settings of the console.
    Export(export::Arguments),
    /// Score the diagnosis on recordings with something hidden in them.
    Blind(blind::Arguments),
}

impl Command {
    /// Where it will write, and what it must not write over.
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

    /// Does it.
    ///
    /// # Errors
    /// [`Failure`] with cause and mend.
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
