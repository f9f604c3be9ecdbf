//! From an answer to text.

use core::fmt;

use super::command::{COMMANDS, ParseError};
use crate::controller::{ArmError, Mode, ReferenceError, Status, ZeroError};
use crate::decimal::{Decimal, Fixed};
use crate::excitation::ExcitationError;
use crate::metrics::StepReport;
use crate::safety::{Counters, FaultLog};
use crate::settings::{FIELDS, SettingError, Settings, Shown};
use crate::units::DEG_PER_RAD;

/// What the console says; its `Display` is one or more lines without the last line end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The list of commands.
    Help,
    /// One setting.
    Setting(Shown),
    /// All settings.
    Settings(Settings),
    /// The state of the controller.
    Status(Status),
    /// The last faults, and how often limits acted.
    Faults(FaultLog, Counters),
    /// That a sign of life was heard.
    Beat,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Help => lines(f, &COMMANDS, |f, usage| {
                write!(f, "{} {}: {}", usage.name, usage.arguments, usage.purpose)
            }),
            Self::Setting(shown) => shown.fmt(f),
            Self::Settings(settings) => lines(f, FIELDS, |f, field| field.shown(settings).fmt(f)),
            Self::Status(status) => status.fmt(f),
            Self::Faults(faults, counters) => {
                if let Some(cause) = faults.reset {
                    write!(f, "last reset: {cause}\r\n")?;
                }
                if faults.is_empty() {
                    f.write_str("no fault")?;
                }
                for (index, record) in faults.iter().enumerate() {
                    write!(f, "{}{record}", if index > 0 { "\r\n" } else { "" })?;
                }
                f.write_str("\r\nlimits acted: ")?;
                for (index, (acted, name)) in Counters::NAMES.iter().enumerate() {
                    let comma = if index > 0 { ", " } else { "" };
                    write!(f, "{comma}{name} {}", counters.of(*acted))?;
                }
                Ok(())
            }
            Self::Beat => f.write_str("beat"),
        }
    }
}

fn lines<T>(
    f: &mut fmt::Formatter<'_>,
    items: &'static [T],
    mut line: impl FnMut(&mut fmt::Formatter<'_>, &'static T) -> fmt::Result,
) -> fmt::Result {
    for (index, item) in items.iter().enumerate() {
        if index > 0 {
            f.write_str("\r\n")?;
        }
        line(f, item)?;
    }
    Ok(())
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "off",
            Self::Idle => "idle",
            Self::Torque => "torque",
            Self::Position => "position",
        })
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "mode {}, {}",
            self.mode,
            if self.zeroed { "zeroed" } else { "no zero" }
        )?;
        write!(
            f,
            ", position {} deg",
            Fixed(self.position_rad * DEG_PER_RAD, 3)
        )?;
        write!(f, ", hall {} deg", Fixed(self.hall_rad * DEG_PER_RAD, 2))?;
        write!(
            f,
            ", velocity {} deg/s",
            Fixed(self.velocity_rad_s * DEG_PER_RAD, 1)
        )?;
        write!(f, ", torque {} mN m", Fixed(self.torque_nm * 1e3, 3))?;
        write!(f, ", current {} A", Fixed(self.current_a, 3))?;
        if self.mode == Mode::Position {
            write!(
                f,
                ", setpoint {} deg",
                Fixed(self.setpoint_rad * DEG_PER_RAD, 3)
            )?;
        }
        if let Some(fault) = self.fault {
            write!(f, "\r\nfault: {fault}")?;
        }
        if let Some(metrics) = self.metrics {
            write!(f, "\r\n{metrics}")?;
        }
        if let Some(breakaway) = self.breakaway {
            write!(f, "\r\nbreakaway at {}", Decimal(breakaway))?;
        }
        Ok(())
    }
}

impl fmt::Display for StepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "overshoot {} deg",
            Fixed(self.overshoot_rad * DEG_PER_RAD, 2)
        )?;
        match self.rise_s {
            Some(rise_s) => write!(f, ", rise {} ms", Fixed(rise_s * 1e3, 2))?,
            None => f.write_str(", rise never")?,
        }
        match self.settling_s {
            Some(settling_s) => write!(f, ", settled {} ms", Fixed(settling_s * 1e3, 2))?,
            None => f.write_str(", not settled")?,
        }
        write!(
            f,
            ", error {} deg",
            Fixed(self.steady_state_error_rad * DEG_PER_RAD, 3)
        )?;
        write!(f, " after {} ms", Fixed(self.elapsed_s * 1e3, 0))
    }
}

/// Why the console does not do what it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The line is no command.
    Parse(ParseError),
    /// The setting.
    Setting(SettingError),
    /// Arming.
    Arm(ArmError),
    /// The zero.
    Zero(ZeroError),
    /// The reference.
    Reference(ReferenceError),
    /// The excitation.
    Excitation(ExcitationError),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parse(error) => error.fmt(f),
            Self::Setting(error) => error.fmt(f),
            Self::Arm(error) => error.fmt(f),
            Self::Zero(error) => error.fmt(f),
            Self::Reference(error) => error.fmt(f),
            Self::Excitation(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Refusal {}

macro_rules! refusal_from {
    ($($error:ident => $variant:ident),+) => {
        $(impl From<$error> for Refusal {
            fn from(error: $error) -> Self {
                Self::$variant(error)
            }
        })+
    };
}

refusal_from!(
    ParseError => Parse, SettingError => Setting, ArmError => Arm, ZeroError => Zero, ReferenceError => Reference,
    ExcitationError => Excitation
);
