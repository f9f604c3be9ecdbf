//! Answers of the console and their text.

use core::fmt;

use super::command::{COMMANDS, ParseError, Topic};
use super::telemetry::{TelemetryAnswer, TelemetryRefusal};
use crate::controller::{ArmError, Mode, ReferenceError, Status, ZeroError};
use crate::decimal::{Decimal, Fixed};
use crate::excitation::ExcitationError;
use crate::metrics::StepReport;
use crate::safety::{Counters, FaultLog};
use crate::settings::{FIELDS, Field, FieldSet, SettingError, Settings, Shown, StoreError};
use crate::units::DEG_PER_RAD;

/// An answer of the console: one or more lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Help on a topic.
    Help(Topic, Settings),
    /// A changed setting.
    Changed(Shown),
    /// The values of some settings.
    Settings(FieldSet, Settings),
    /// All settings as commands.
    Dump(Settings),
    /// The settings are stored.
    Saved,
    /// The stored settings are in force. The number counts values that were ignored.
    Loaded(usize),
    /// The default settings are in force.
    Defaults,
    /// The state of the controller.
    Status(Status),
    /// The last faults and the counts of limits.
    Faults(FaultLog, Counters),
    /// A heartbeat was received.
    Beat,
    /// Duration of the control interrupt, where it is measured.
    Timing(Option<Timing>),
    /// Version of the firmware.
    Version,
    /// State of the telemetry.
    Telemetry(TelemetryAnswer),
    /// The new baud rate of the serial line.
    Baud(u32),
}

impl Answer {
    /// Number of lines.
    pub fn lines(&self) -> usize {
        match self {
            Self::Help(Topic::Commands, _) => COMMANDS.len(),
            Self::Help(Topic::Command(_), _) => 2,
            Self::Help(Topic::Settings(fields), _) | Self::Settings(fields, _) => fields.count(),
            Self::Dump(_) => FIELDS.len(),
            Self::Faults(faults, _) => {
                usize::from(faults.reset.is_some()) + faults.len().max(1) + 1
            }
            Self::Changed(_)
            | Self::Saved
            | Self::Loaded(_)
            | Self::Defaults
            | Self::Status(_)
            | Self::Beat
            | Self::Timing(_)
            | Self::Version
            | Self::Telemetry(_)
            | Self::Baud(_) => 1,
        }
    }

    /// The line with this number, from 0, without its line end.
    pub fn line(&self, number: usize) -> impl fmt::Display {
        Line(self, number)
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (0..self.lines()).try_for_each(|number| {
            f.write_str(if number > 0 { "\r\n" } else { "" })?;
            Line(self, number).fmt(f)
        })
    }
}

struct Line<'a>(&'a Answer, usize);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(answer, number) = *self;
        match answer {
            Answer::Help(Topic::Commands, _) => match COMMANDS.get(number) {
                Some(usage) => usage.fmt(f),
                None => Ok(()),
            },
            Answer::Help(Topic::Command(usage), _) if number == 0 => usage.fmt(f),
            Answer::Help(Topic::Command(usage), _) => write!(f, "example: {}", usage.example),
            Answer::Help(Topic::Settings(fields), settings) => match fields.iter().nth(number) {
                Some(field) => {
                    setting(f, field, settings)?;
                    write!(
                        f,
                        ", default {}: {}",
                        field.default_shown().value(),
                        field.about
                    )
                }
                None => Ok(()),
            },
            Answer::Settings(fields, settings) => match fields.iter().nth(number) {
                Some(field) => setting(f, field, settings),
                None => Ok(()),
            },
            Answer::Dump(settings) => match FIELDS.get(number) {
                Some(field) => field.shown(settings).as_command().fmt(f),
                None => Ok(()),
            },
            Answer::Changed(shown) => shown.fmt(f),
            Answer::Saved => f.write_str("saved"),
            Answer::Loaded(left_out) => loaded(f, *left_out),
            Answer::Defaults => f.write_str("the settings are the defaults; save stores them"),
            Answer::Status(status) => status.fmt(f),
            Answer::Faults(faults, counters) => faults_line(f, faults, *counters, number),
            Answer::Beat => f.write_str("beat"),
            Answer::Timing(Some(timing)) => timing.fmt(f),
            Answer::Timing(None) => f.write_str("nobody measures it here"),
            Answer::Version => f.write_str(VERSION),
            Answer::Telemetry(answer) => answer.fmt(f),
            Answer::Baud(baud) => write!(f, "{baud} baud from the next prompt on"),
        }
    }
}

/// Version of the firmware, with the commit from which it was built.
pub const VERSION: &str = concat!(
    "haptic paddle ",
    env!("CARGO_PKG_VERSION"),
    ", commit ",
    env!("PADDLE_COMMIT")
);

/// Duration of the control interrupt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Duration of the last interrupt, s.
    pub last_s: f32,
    /// Longest duration since the last query, s.
    pub worst_s: f32,
    /// Length of a control period, s.
    pub period_s: f32,
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the control interrupt takes {} us, {} us at worst since the last question, of {} us",
            Fixed(self.last_s * 1e6, 2),
            Fixed(self.worst_s * 1e6, 2),
            Fixed(self.period_s * 1e6, 0)
        )
    }
}

/// Text: stored settings are in force.
fn loaded(f: &mut fmt::Formatter<'_>, left_out: usize) -> fmt::Result {
    f.write_str("the settings are the stored ones")?;
    match left_out {
        0 => Ok(()),
        _ => write!(
            f,
            ", but {left_out} of them that this firmware does not know or allow, which are the defaults"
        ),
    }
}

/// A setting with its value and its allowed values.
fn setting(f: &mut fmt::Formatter<'_>, field: &'static Field, settings: &Settings) -> fmt::Result {
    write!(f, "{} ({})", field.shown(settings), field.kind)
}

/// The cause of the reset, if known, the faults, and the counts of limits.
fn faults_line(
    f: &mut fmt::Formatter<'_>,
    faults: &FaultLog,
    counters: Counters,
    number: usize,
) -> fmt::Result {
    let record = match (faults.reset, number) {
        (Some(cause), 0) => return write!(f, "last reset: {cause}"),
        (Some(_), number) => number - 1,
        (None, number) => number,
    };
    if let Some(record) = faults.iter().nth(record) {
        return fmt::Display::fmt(record, f);
    }
    if faults.is_empty() && record == 0 {
        return f.write_str("no fault");
    }
    f.write_str("limits acted: ")?;
    Counters::NAMES
        .iter()
        .enumerate()
        .try_for_each(|(index, (acted, name))| {
            let comma = if index > 0 { ", " } else { "" };
            write!(f, "{comma}{name} {}", counters.of(*acted))
        })
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

/// Why the console refuses a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The line is not a valid command.
    Parse(ParseError),
    /// A setting was refused.
    Setting(SettingError),
    /// Storing or loading settings failed.
    Store(StoreError),
    /// Arming was refused.
    Arm(ArmError),
    /// Setting the zero was refused.
    Zero(ZeroError),
    /// The reference was refused.
    Reference(ReferenceError),
    /// The excitation was refused.
    Excitation(ExcitationError),
    /// Telemetry was refused.
    Telemetry(TelemetryRefusal),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parse(error) => error.fmt(f),
            Self::Setting(error) => error.fmt(f),
            Self::Store(error) => error.fmt(f),
            Self::Arm(error) => error.fmt(f),
            Self::Zero(error) => error.fmt(f),
            Self::Reference(error) => error.fmt(f),
            Self::Excitation(error) => error.fmt(f),
            Self::Telemetry(error) => error.fmt(f),
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
    ParseError => Parse, SettingError => Setting, StoreError => Store, ArmError => Arm, ZeroError => Zero,
    ReferenceError => Reference, ExcitationError => Excitation, TelemetryRefusal => Telemetry
);
