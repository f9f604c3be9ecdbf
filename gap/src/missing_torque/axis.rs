//! The quantities that a missing torque may be a function of.

use serde::Serialize;
use std::fmt;

/// A quantity along a motion that a missing torque may go with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(into = "&'static str")]
pub enum Axis {
    /// None: the torque is the same all along.
    Constant,
    /// Velocity, with another function for either direction.
    Velocity,
    /// The part of a function of velocity that is against the motion.
    VelocityOdd,
    /// The part of a function of velocity that has one sign in both directions.
    VelocityEven,
    /// Position, waves over it included.
    Position,
    /// Torque of the input.
    Input,
    /// The model's own torque, which accelerates.
    Acceleration,
    /// Size of the driving torque, against the motion: where the motor drives, and where the load does.
    Load,
    /// Position, against the motion.
    DirectionAndPosition,
    /// Way since the last reversal, and late input.
    Memory,
    /// Time of the session.
    Time,
    /// Place within a wave over the position.
    Wave,
}

impl Axis {
    /// Its name in JSON, text and pictures.
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
