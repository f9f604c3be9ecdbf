//! The formats that a device can be written in.

use std::str::FromStr;

/// For which simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MuJoCo's XML.
    Mjcf,
    /// ROS's robot description.
    Urdf,
    /// Universal Scene Description with UsdPhysics and PhysX's joint attributes.
    Usd,
    /// A MATLAB function for a block of Simulink.
    SimulinkM,
    /// A module without dependencies.
    Python,
    /// Settings of this project's own console: friction and gravity compensation.
    Console,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Mjcf,
        Self::Urdf,
        Self::Usd,
        Self::SimulinkM,
        Self::Python,
        Self::Console,
    ];

    /// Its name on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Usd => "usd",
            Self::SimulinkM => "simulink-m",
            Self::Python => "python",
            Self::Console => "console",
        }
    }

    /// The simulator or program that reads the format, in one line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Mjcf => "MuJoCo's XML",
            Self::Urdf => "ROS's robot description",
            Self::Usd => "USD with UsdPhysics, for Isaac Sim",
            Self::SimulinkM => "A MATLAB function for a block of Simulink",
            Self::Python => "A Python module without dependencies",
            Self::Console => "Settings of this project's console that cancel friction and gravity",
        }
    }

    /// The usual extension of a file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
            Self::Usd => "usda",
            Self::SimulinkM => "m",
            Self::Python => "py",
            Self::Console => "txt",
        }
    }
}

/// A name that no format has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no format `{0}`; there are {known}", known = Format::ALL.map(Format::name).join(", "))]
pub struct UnknownFormat(String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        let found = Self::ALL.into_iter().find(|format| format.name() == name);
        found.ok_or_else(|| UnknownFormat(name.to_owned()))
    }
}
