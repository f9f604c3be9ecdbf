//! Parses a line into a command.

use core::fmt;

use link::ChannelsError;

use super::telemetry::{self, TelemetryCommand};
use crate::controller::Mode;
use crate::decimal;
use crate::excitation::{Excitation, Shape};
use crate::procedures::ProcedureKind;
use crate::settings::{Field, FieldSet, SettingError};

/// Largest length of a line without its end, bytes.
pub const MAX_LINE_BYTES: usize = 80;

/// Usage of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// The first word.
    pub name: &'static str,
    /// The words after it.
    pub arguments: &'static str,
    /// The purpose of the command.
    pub purpose: &'static str,
    /// An example line.
    pub example: &'static str,
}

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let space = if self.arguments.is_empty() { "" } else { " " };
        write!(
            f,
            "{}{space}{}: {}",
            self.name, self.arguments, self.purpose
        )
    }
}

/// All commands.
pub static COMMANDS: [Usage; 29] = [
    HELP, GET, SET, DUMP, SAVE, LOAD, DEFAULTS, ARM, DISARM, ZERO, REF, STEP, START, STOP, STATUS,
    FAULTS, CLEAR, BEAT, STREAM, CAPTURE, BAUD, FRICTION, HALL, MOTOR, ZN, TIMING, VERSION, HELLO,
    REBOOT,
];

const HELP: Usage = Usage {
    name: "help",
    arguments: "[COMMAND|SETTING]",
    purpose: "the commands, or all about one, or about a setting",
    example: "help set",
};
const GET: Usage = Usage {
    name: "get",
    arguments: "[NAME]",
    purpose: "show settings with their ranges: all, a group, or one",
    example: "get pid",
};
const SET: Usage = Usage {
    name: "set",
    arguments: "NAME VALUE",
    purpose: "change a setting, in the unit that get shows",
    example: "set pid.kp 0.05",
};
const DUMP: Usage = Usage {
    name: "dump",
    arguments: "",
    purpose: "all settings as commands, to be pasted back",
    example: "dump",
};
const SAVE: Usage = Usage {
    name: "save",
    arguments: "",
    purpose: "store the settings, which then outlive a loss of the supply; disarmed only",
    example: "save",
};
const LOAD: Usage = Usage {
    name: "load",
    arguments: "",
    purpose: "the settings as stored",
    example: "load",
};
const DEFAULTS: Usage = Usage {
    name: "defaults",
    arguments: "",
    purpose: "the settings as by default; what is stored stays until save",
    example: "defaults",
};
const ARM: Usage = Usage {
    name: "arm",
    arguments: "[position|torque]",
    purpose: "start to control",
    example: "arm torque",
};
const DISARM: Usage = Usage {
    name: "disarm",
    arguments: "",
    purpose: "motor off",
    example: "disarm",
};
const ZERO: Usage = Usage {
    name: "zero",
    arguments: "[hall|DEG]",
    purpose: "the paddle stands at 0, at DEG, or where the Hall sensor says",
    example: "zero hall",
};
const REF: Usage = Usage {
    name: "ref",
    arguments: "VALUE",
    purpose: "reference: deg in position mode, N m at the motor in torque mode",
    example: "ref -5",
};
const STEP: Usage = Usage {
    name: "step",
    arguments: "VALUE",
    purpose: "step from the reference, with metrics",
    example: "step 10",
};
const START: Usage = Usage {
    name: "start",
    arguments: "step A [S] | ramp A S | sine|square|triangle|multisine A HZ [S] | chirp A HZ HZ S",
    purpose: "test signal of amplitude A for S seconds on top of the reference",
    example: "start sine 10 0.5 20",
};
const STOP: Usage = Usage {
    name: "stop",
    arguments: "",
    purpose: "end the test signal",
    example: "stop",
};
const STATUS: Usage = Usage {
    name: "status",
    arguments: "",
    purpose: "mode, fault, position, torque, current, step metrics",
    example: "status",
};
const FAULTS: Usage = Usage {
    name: "faults",
    arguments: "",
    purpose: "the last faults with what was there, first cause first, and how often limits acted",
    example: "faults",
};
const CLEAR: Usage = Usage {
    name: "clear",
    arguments: "",
    purpose: "let go of the latched fault",
    example: "clear",
};
const BEAT: Usage = Usage {
    name: "beat",
    arguments: "[off]",
    purpose: "a program steers: silence for host.heartbeat is a fault from now on, until off",
    example: "beat",
};
const STREAM: Usage = Usage {
    name: "stream",
    arguments: "[CHANNEL,CHANNEL,...|all HZ | off]",
    purpose: "send rows of these channels as binary frames, or end it",
    example: "stream encoder,torque 2000",
};
const CAPTURE: Usage = Usage {
    name: "capture",
    arguments: "[fault|step|now [MS] | CHANNEL VALUE [MS] | send]",
    purpose: "every control period in memory, MS of it before the trigger; or send it as binary frames",
    example: "capture step 20",
};
const BAUD: Usage = Usage {
    name: "baud",
    arguments: "RATE",
    purpose: "another rate of the serial line, from the next prompt on",
    example: "baud 1843200",
};

const FRICTION: Usage = Usage {
    name: "friction",
    arguments: "",
    purpose: "measure the dry friction, both ways and at three angles; the paddle moves, half a minute",
    example: "friction",
};
const HALL: Usage = Usage {
    name: "hall",
    arguments: "cal",
    purpose: "calibrate the Hall sensor against the encoder; the paddle goes from end to end, 20 s",
    example: "hall cal",
};
const MOTOR: Usage = Usage {
    name: "motor",
    arguments: "id",
    purpose: "measure resistance, inductance and the current's offset; the motor hums for a second",
    example: "motor id",
};
const ZN: Usage = Usage {
    name: "zn",
    arguments: "",
    purpose: "ultimate gain and period by a relay, and gains by Ziegler and Nichols; the paddle swings, 5 s",
    example: "zn",
};
const TIMING: Usage = Usage {
    name: "timing",
    arguments: "",
    purpose: "how long the control interrupt takes, now and at worst since the last question",
    example: "timing",
};
const VERSION: Usage = Usage {
    name: "version",
    arguments: "",
    purpose: "the version of the firmware, and the commit that it was made from",
    example: "version",
};
const HELLO: Usage = Usage {
    name: "hello",
    arguments: "",
    purpose: "the greeting again",
    example: "hello",
};
const REBOOT: Usage = Usage {
    name: "reboot",
    arguments: "",
    purpose: "begin anew, as after a reset; disarmed only",
    example: "reboot",
};

/// Finds the command with this name, or the only one whose name begins with it.
///
/// # Errors
///
/// [`ParseError`] if no command or several commands match.
pub fn find(text: &str) -> Result<&'static Usage, ParseError> {
    if let Some(usage) = COMMANDS.iter().find(|usage| usage.name == text) {
        return Ok(usage);
    }
    let mut like = COMMANDS.iter().filter(|usage| usage.name.starts_with(text));
    match (like.next(), like.next()) {
        (None, _) => Err(ParseError::UnknownCommand),
        (Some(usage), None) => Ok(usage),
        (Some(first), Some(second)) => Err(ParseError::AmbiguousCommand(first.name, second.name)),
    }
}

/// Topic of help.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Topic {
    /// All commands.
    Commands,
    /// One command.
    Command(&'static Usage),
    /// Settings.
    Settings(FieldSet),
}

/// Source of the encoder's zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// The Hall sensor.
    Hall,
    /// A stated angle.
    At {
        /// Present angle of the paddle, degrees.
        angle_deg: f32,
    },
}

/// A parsed command. Numbers are in user units: degrees, or N m at the motor in torque mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Show help.
    Help(Topic),
    /// Show settings with their values.
    Get(FieldSet),
    /// Show all settings as commands.
    Dump,
    /// Store the settings.
    Save,
    /// Load the stored settings.
    Load,
    /// Restore the default settings.
    Defaults,
    /// Set a setting to a value, which is within its bounds.
    Set(&'static Field, f32),
    /// Arm in a mode.
    Arm(Mode),
    /// Motor off.
    Disarm,
    /// Set the zero of the encoder.
    Zero(Zero),
    /// Set the reference.
    Reference(f32),
    /// Start an excitation.
    Start(Excitation),
    /// Stop the excitation.
    Stop,
    /// Show the state of the controller.
    Status,
    /// Show the last faults.
    Faults,
    /// Clear the latched fault.
    Clear,
    /// Start or stop the heartbeat supervision of a host program.
    Beat(bool),
    /// Control a stream or a capture.
    Telemetry(TelemetryCommand),
    /// Change the baud rate of the serial line, bit/s.
    Baud(u32),
    /// Run a procedure by which the paddle measures itself.
    Procedure(ProcedureKind),
    /// Show the duration of the control interrupt.
    Timing,
    /// Show the version of the firmware.
    Version,
    /// Show the greeting.
    Hello,
    /// Restart the firmware.
    Reboot,
}

/// Why a line is not a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParseError {
    /// It is longer than [`MAX_LINE_BYTES`].
    TooLong,
    /// It is not plain text.
    NotText,
    /// The first word is not a command.
    UnknownCommand,
    /// The first word is the beginning of these two commands, and possibly of more.
    AmbiguousCommand(&'static str, &'static str),
    /// The arguments do not match the usage.
    Usage(&'static Usage),
    /// The setting or its value is refused.
    Setting(SettingError),
    /// No telemetry channel has this name.
    UnknownChannel,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "line longer than {MAX_LINE_BYTES} characters"),
            Self::NotText => f.write_str("line is not plain text: check the baud rate"),
            Self::UnknownCommand => f.write_str("no such command: help lists them"),
            Self::AmbiguousCommand(first, second) => {
                write!(
                    f,
                    "write more of the command, it may be {first} or {second}"
                )
            }
            Self::Usage(Usage {
                name,
                arguments: "",
                ..
            }) => write!(f, "write {name} alone"),
            Self::Usage(Usage {
                name, arguments, ..
            }) => write!(f, "write {name} {arguments}"),
            Self::Setting(error) => error.fmt(f),
            Self::UnknownChannel => ChannelsError.fmt(f),
        }
    }
}

impl core::error::Error for ParseError {}

impl From<SettingError> for ParseError {
    fn from(error: SettingError) -> Self {
        Self::Setting(error)
    }
}

/// Parses a line. Text after a `#` is a comment. Returns `None` for an empty line. Names of commands and settings may be
/// shortened as long as they are unique.
///
/// # Errors
///
/// [`ParseError`].
pub fn parse(line: &[u8]) -> Result<Option<Command>, ParseError> {
    let line = line.trim_ascii();
    if line.len() > MAX_LINE_BYTES {
        return Err(ParseError::TooLong);
    }
    if !line.is_ascii() {
        return Err(ParseError::NotText);
    }
    let line = core::str::from_utf8(line).map_err(|_| ParseError::NotText)?;
    let line = line.split('#').next().unwrap_or_default();
    let mut words = line.split_ascii_whitespace();
    let Some(name) = words.next() else {
        return Ok(None);
    };
    let usage = find(name)?;
    let mut arguments = Arguments { words, usage };
    let command = match usage.name {
        "help" => Command::Help(match arguments.optional() {
            None => Topic::Commands,
            Some(word) => match (find(word), FieldSet::named(word)) {
                (Ok(usage), _) => Topic::Command(usage),
                (Err(_), Ok(fields)) => Topic::Settings(fields),
                (Err(error), Err(_)) => return Err(error),
            },
        }),
        "get" => Command::Get(match arguments.optional() {
            None => FieldSet::ALL,
            Some(name) => FieldSet::named(name)?,
        }),
        "set" => {
            let field = FieldSet::named(arguments.word()?)?.only()?;
            Command::Set(field, field.parse(arguments.word()?)?)
        }
        "dump" => Command::Dump,
        "save" => Command::Save,
        "load" => Command::Load,
        "defaults" => Command::Defaults,
        "arm" => Command::Arm(match arguments.optional() {
            None | Some("position") => Mode::Position,
            Some("torque") => Mode::Torque,
            Some(_) => return Err(arguments.misused()),
        }),
        "disarm" => Command::Disarm,
        "zero" => Command::Zero(match arguments.optional() {
            None => Zero::At { angle_deg: 0.0 },
            Some("hall") => Zero::Hall,
            Some(word) => Zero::At {
                angle_deg: arguments.finite(word)?,
            },
        }),
        "ref" => Command::Reference(arguments.number()?),
        "step" => Command::Start(Excitation::step(arguments.number()?)),
        "start" => Command::Start(arguments.excitation()?),
        "stop" => Command::Stop,
        "clear" => Command::Clear,
        "faults" => Command::Faults,
        "beat" => Command::Beat(match arguments.optional() {
            None => true,
            Some("off") => false,
            Some(_) => return Err(arguments.misused()),
        }),
        "friction" => Command::Procedure(ProcedureKind::Friction),
        "hall" => Command::Procedure(arguments.exactly("cal", ProcedureKind::Hall)?),
        "motor" => Command::Procedure(arguments.exactly("id", ProcedureKind::Motor)?),
        "zn" => Command::Procedure(ProcedureKind::ZieglerNichols),
        "timing" => Command::Timing,
        "version" => Command::Version,
        "hello" => Command::Hello,
        "reboot" => Command::Reboot,
        "stream" => Command::Telemetry(telemetry::stream(&mut arguments)?),
        "capture" => Command::Telemetry(telemetry::capture(&mut arguments)?),
        "baud" => Command::Baud(telemetry::baud(&mut arguments)?),
        _ => Command::Status,
    };
    if arguments.optional().is_some() {
        return Err(arguments.misused());
    }
    Ok(Some(command))
}

pub(super) struct Arguments<'a> {
    words: core::str::SplitAsciiWhitespace<'a>,
    usage: &'static Usage,
}

impl<'a> Arguments<'a> {
    /// Returns `meant` if the next word is `word`.
    fn exactly<T>(&mut self, word: &str, meant: T) -> Result<T, ParseError> {
        if self.word()? == word {
            Ok(meant)
        } else {
            Err(self.misused())
        }
    }

    pub(super) fn misused(&self) -> ParseError {
        ParseError::Usage(self.usage)
    }

    pub(super) fn optional(&mut self) -> Option<&'a str> {
        self.words.next()
    }

    pub(super) fn word(&mut self) -> Result<&'a str, ParseError> {
        self.optional().ok_or(self.misused())
    }

    pub(super) fn number(&mut self) -> Result<f32, ParseError> {
        let word = self.word()?;
        self.finite(word)
    }

    pub(super) fn finite(&self, word: &str) -> Result<f32, ParseError> {
        decimal::parse(word)
            .filter(|number: &f32| number.is_finite())
            .ok_or(self.misused())
    }

    fn excitation(&mut self) -> Result<Excitation, ParseError> {
        let name = self.word()?;
        let (_, shape) = Shape::NAMED
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or(self.misused())?;
        let mut excitation = Excitation {
            shape: *shape,
            ..Excitation::step(self.number()?)
        };
        match shape {
            Shape::Step => {}
            Shape::Ramp => {
                excitation.duration_s = self.number()?;
                return Ok(excitation);
            }
            Shape::Sine | Shape::Square | Shape::Triangle | Shape::Multisine => {
                excitation.frequency_hz = self.number()?;
            }
            Shape::Chirp => {
                excitation.frequency_hz = self.number()?;
                excitation.end_frequency_hz = self.number()?;
                excitation.duration_s = self.number()?;
                return Ok(excitation);
            }
        }
        if let Some(word) = self.optional() {
            excitation.duration_s = self.finite(word)?;
        }
        Ok(excitation)
    }
}
