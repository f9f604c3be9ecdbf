//! The formats in which a device can be written.

use std::str::FromStr;

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The XML format of MuJoCo.
    Mjcf,
    /// The robot description of ROS.
    Urdf,
    /// Universal Scene Description with UsdPhysics and the joint attributes of PhysX.
    Usd,
    /// A MATLAB function for a Simulink block.
    SimulinkM,
    /// A Python module without dependencies.
    Python,
    /// Settings of this project's console: friction and gravity compensation.
    Console,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 6] = [
        Self::Mjcf,
        Self::Urdf,
        Self::Usd,
        Self::SimulinkM,
        Self::Python,
        Self::Console,
    ];

    /// Its name on the command line.
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

    /// The usual file name extension.
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

/// No format has this name.
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
