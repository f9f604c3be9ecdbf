//! The commands, one module each.

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

/// Commands of the program.
#[derive(Subcommand)]
pub enum Command {
    /// Demonstrate a step response, and a gap with its diagnosis, in seconds.
    Demo(demo::Arguments),
    /// Simulate the control core with the paddle.
    #[command(subcommand)]
    Sim(sim::Command),
    /// Run the firmware image on a virtual board that is connected to the simulated paddle.
    Board(board::Arguments),
    /// Run experiments on a board and write a recording.
    Record(record::Arguments),
    /// Record and diagnose alternately until only one answer is left.
    Experiment(experiment::Arguments),
    /// Plot the signals of a board's control loop live in the terminal.
    Scope(scope::Arguments),
    /// Read a board's settings into a file, or write them to a board.
    #[command(subcommand)]
    Settings(settings::Command),
    /// Measure the gap between a simulation and a recording, and diagnose its cause.
    #[command(subcommand)]
    Gap(gap::Command),
    /// Compare every number and figure of the lab report with the simulation.
    Reproduce(reproduce::Arguments),
    /// List the effects that can be added to the simulated paddle.
    Effects(effects::Arguments),
    /// Print the completion script of a shell.
    Completions(completions::Arguments),
    /// Write a manual page for each command.
    Man(man::Arguments),
}

impl Command {
    /// Paths that the command writes, and paths that it must not overwrite.
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

    /// Runs the command.
    ///
    /// # Errors
    /// Returns a [`Failure`] with the cause and a remedy.
    pub fn run(&self) -> Result<Answer, Failure> {
        let mut answer = match self {
            Self::Demo(arguments) => demo::run(arguments),
            Self::Sim(command) => command.run(),
            Self::Board(arguments) => board::run(arguments),
            Self::Record(arguments) => record::run(arguments),
            Self::Experiment(arguments) => experiment::run(arguments),
            Self::Scope(arguments) => scope::run(arguments),
            Self::Settings(command) => command.run(),
            // The JSON of these commands follows the recording format.
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
