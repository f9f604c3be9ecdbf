//! The commands, one file each.

pub mod board;
pub mod completions;
pub mod demo;
pub mod effects;
pub mod experiment;
pub mod gap;
pub mod man;
pub mod record;
pub mod reproduce;
pub mod scope;
pub mod settings;
pub mod sim;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::Target;
use clap::Subcommand;

/// What can be asked.
#[derive(Subcommand)]
pub enum Command {
    /// Show a step response, and a gap with its diagnosis, in seconds.
    Demo(demo::Arguments),
    /// Run the control core on the simulated paddle.
    #[command(subcommand)]
    Sim(sim::Command),
    /// Run the flashed image on a virtual board that is wired to the simulated paddle.
    Board(board::Arguments),
    /// Drive a board through experiments, and write a recording.
    Record(record::Arguments),
    /// Record and diagnose in turn until only one answer is left.
    Experiment(experiment::Arguments),
    /// Draw what a board's loop does in the terminal, as it happens.
    Scope(scope::Arguments),
    /// Read a board's settings into a file, or write them to a board.
    #[command(subcommand)]
    Settings(settings::Command),
    /// Measure the gap between a simulation and a recording.
    #[command(subcommand)]
    Gap(gap::Command),
    /// Compare every number and figure of the lab report with ours.
    Reproduce(reproduce::Arguments),
    /// List the effects that can be switched into the simulated paddle.
    Effects(effects::Arguments),
    /// Print a script by which a shell completes commands and options.
    Completions(completions::Arguments),
    /// Write a manual page for each command.
    Man(man::Arguments),
}

impl Command {
    /// Where it will write, and what it must not write over.
    pub fn targets(&self) -> Vec<Target<'_>> {
        match self {
            Self::Demo(arguments) => arguments.targets(),
            Self::Sim(command) => command.targets(),
            Self::Board(arguments) => arguments.targets(),
            Self::Record(arguments) => arguments.targets(),
            Self::Experiment(arguments) => arguments.targets(),
            Self::Scope(_) => Vec::new(),
            Self::Settings(command) => command.targets(),
            Self::Gap(command) => command.targets(),
            Self::Reproduce(arguments) => arguments.targets(),
            Self::Effects(arguments) => arguments.targets(),
            Self::Completions(_) => Vec::new(),
            Self::Man(arguments) => arguments.targets(),
        }
    }

    /// Does it.
    ///
    /// # Errors
    /// [`Failure`] with cause and mend.
    pub fn run(&self) -> Result<Answer, Failure> {
        let mut answer = match self {
            Self::Demo(arguments) => demo::run(arguments),
            Self::Sim(command) => command.run(),
            Self::Board(arguments) => board::run(arguments),
            Self::Record(arguments) => record::run(arguments),
            Self::Experiment(arguments) => experiment::run(arguments),
            Self::Scope(arguments) => scope::run(arguments),
            Self::Settings(command) => command.run(),
            // Its JSON is the recording format's.
            Self::Gap(command) => return command.run(),
            Self::Reproduce(arguments) => reproduce::run(arguments),
            Self::Effects(arguments) => effects::run(arguments),
            Self::Completions(arguments) => Ok(completions::run(arguments)),
            Self::Man(arguments) => man::run(arguments),
        }?;
        answer.json["version"] = env!("CARGO_PKG_VERSION").into();
        Ok(answer)
    }
}
