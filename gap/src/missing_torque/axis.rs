//! The quantities of which a missing torque may be a function.

use serde::Serialize;
use std::fmt;

/// A quantity along a motion of which the missing torque may be a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(into = "&'static str")]
pub enum Axis {
    /// No quantity: the torque is constant.
    Constant,
    /// Velocity, with separate functions for both directions.
    Velocity,
    /// The odd part of a function of velocity, which opposes the motion.
    VelocityOdd,
    /// The even part of a function of velocity, which has the same sign in both directions.
    VelocityEven,
    /// Position, including waves over the position.
    Position,
    /// Drive torque.
    Input,
    /// Acceleration by the torque of the model.
    Acceleration,
    /// Friction that depends on the magnitude of the drive torque, separately for a driving motor and for a driving load.
    Load,
    /// Friction that depends on the position.
    DirectionAndPosition,
    /// Distance since the last reversal, and delayed input.
    Memory,
    /// Time on the clock of the session.
    Time,
    /// Phase of a wave over the position.
    Wave,
}

impl Axis {
    /// The name of the axis in JSON, text and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Velocity => "velocity",
            Self::VelocityOdd => "velocity odd",
            Self::VelocityEven => "velocity even",
            Self::Position => "position",
            Self::Input => "input",
            Self::Acceleration => "acceleration",
            Self::Load => "load",
            Self::DirectionAndPosition => "direction x position",
            Self::Memory => "memory",
            Self::Time => "time",
            Self::Wave => "wave",
        }
    }
}

impl From<Axis> for &'static str {
    fn from(axis: Axis) -> Self {
        axis.name()
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
