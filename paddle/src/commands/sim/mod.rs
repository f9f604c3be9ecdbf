//! `paddle sim`: simulates the control core with the paddle.

mod experiment;
mod filter;
mod lab;
mod rig;
mod tune;
mod zn;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::Target;
use clap::Subcommand;
use haptic_paddle::excitation::Shape;

use experiment::Arguments;
pub use experiment::step_of_refit;
pub use rig::SensorChoice;

/// Subcommands of `paddle sim`.
#[derive(Subcommand)]
pub enum Command {
    /// Simulate a position step; report overshoot, rise time, settling time and steady-state error.
    #[command(
        after_help = "Example: paddle sim step --kp 0.05 --ki 0.28 --kd 0.0008 --plant refit --sensor hall"
    )]
    Step(Arguments),
    /// Simulate a sine.
    #[command(
        after_help = "Example: paddle sim sine --torque --amplitude 0.0011 --frequency 1 --seconds 12 --plant refit"
    )]
    Sine(Arguments),
    /// Simulate a square wave.
    #[command(after_help = "Example: paddle sim square --amplitude 5 --frequency 1 --current-loop")]
    Square(Arguments),
    /// Simulate a chirp: a sine with rising frequency.
    #[command(
        after_help = "Example: paddle sim chirp --amplitude 2 --frequency 0.5 --end-frequency 20 --seconds 10"
    )]
    Chirp(Arguments),
    /// Simulate a multisine of six harmonics.
    #[command(
        after_help = "Example: paddle sim multisine --amplitude 15 --frequency 0.5 --with stribeck --recording my-recording"
    )]
    Multisine(Arguments),
    /// Simulate a rising torque until the paddle breaks away.
    #[command(
        after_help = "Example: paddle sim ramp --amplitude 0.003 --seconds 3 --with stribeck:static_ratio=1.4"
    )]
    Ramp(Arguments),
    /// Simulate a triangle wave.
    #[command(
        after_help = "Example: paddle sim triangle --amplitude 20 --frequency 0.2 --seconds 10"
    )]
    Triangle(Arguments),
    /// Compare the torque noise and the largest stable derivative gain with and without the filter on the position.
    Filter(filter::Arguments),
    /// Find gains for a specification, with stability margins and the worst case over a range of paddles.
    Tune(tune::Arguments),
    /// Find gains by the report's Ziegler-Nichols procedure.
    Zn(zn::Arguments),
    /// Simulate the lab's own Simulink model, in which the dry friction has no effect.
    Lab(lab::Arguments),
}

impl Command {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        match self {
            Self::Step(arguments)
            | Self::Sine(arguments)
            | Self::Square(arguments)
            | Self::Chirp(arguments)
            | Self::Multisine(arguments)
            | Self::Ramp(arguments)
            | Self::Triangle(arguments) => arguments.targets(),
            Self::Filter(arguments) => arguments.targets(),
            Self::Tune(arguments) => arguments.targets(),
            Self::Zn(arguments) => arguments.targets(),
            Self::Lab(arguments) => arguments.targets(),
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// Returns a [`Failure`] with the cause and a remedy.
    pub fn run(&self) -> Result<Answer, Failure> {
        match self {
            Self::Step(arguments) => experiment::run(Shape::Step, arguments),
            Self::Sine(arguments) => experiment::run(Shape::Sine, arguments),
            Self::Square(arguments) => experiment::run(Shape::Square, arguments),
            Self::Chirp(arguments) => experiment::run(Shape::Chirp, arguments),
            Self::Multisine(arguments) => experiment::run(Shape::Multisine, arguments),
            Self::Ramp(arguments) => experiment::run(Shape::Ramp, arguments),
            Self::Triangle(arguments) => experiment::run(Shape::Triangle, arguments),
            Self::Filter(arguments) => filter::run(arguments),
            Self::Tune(arguments) => tune::run(arguments),
            Self::Zn(arguments) => zn::run(arguments),
            Self::Lab(arguments) => lab::run(arguments),
        }
    }
}
