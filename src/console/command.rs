//! From a line to a command.

use core::fmt;

use crate::controller::Mode;
use crate::decimal;
use crate::excitation::{Excitation, Shape};
use crate::settings::{Field, SettingError};

/// Longest line, bytes without its end.
pub const MAX_LINE_BYTES: usize = 80;

/// How a command is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// First word.
    pub name: &'static str,
    /// The words after it.
    pub arguments: &'static str,
    /// What it does.
    pub purpose: &'static str,
}

/// All commands.
pub static COMMANDS: [Usage; 14] = [
    HELP, GET, SET, ARM, DISARM, ZERO, REF, STEP, START, STOP, STATUS, FAULTS, CLEAR, BEAT,
];

const fn usage(name: &'static str, arguments: &'static str, purpose: &'static str) -> Usage {
    Usage {
        name,
        arguments,
        purpose,
    }
}

const HELP: Usage = usage("help", "", "this list");
const GET: Usage = usage("get", "[NAME]", "show one setting, or all");
const SET: Usage = usage(
    "set",
    "NAME VALUE",
    "change a setting, in the unit that get shows",
);
const ARM: Usage = usage("arm", "[position|torque]", "start to control");
const DISARM: Usage = usage("disarm", "", "motor off");
const ZERO: Usage = usage(
    "zero",
    "[hall|DEG]",
    "the paddle stands at 0, at DEG, or where the Hall sensor says",
);
const REF: Usage = usage(
    "ref",
    "VALUE",
    "reference: deg in position mode, N m at the motor in torque mode",
);
const STEP: Usage = usage("step", "VALUE", "step from the reference, with metrics");
const START: Usage = usage(
    "start",
    "step A [S] | ramp A S | sine|square|triangle|multisine A HZ [S] | chirp A HZ HZ S",
    "test signal of amplitude A for S seconds on top of the reference",
);
const STOP: Usage = usage("stop", "", "end the test signal");
const STATUS: Usage = usage(
    "status",
    "",
    "mode, fault, position, torque, current, step metrics",
);
const FAULTS: Usage = usage(
    "faults",
    "",
    "the last faults with what was there, first cause first, and how often limits acted",
);
const CLEAR: Usage = usage("clear", "", "let go of the latched fault");
const BEAT: Usage = usage(
    "beat",
    "",
    "a program steers: silence for host.heartbeat is a fault from now on",
);

/// How the encoder gets its zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// By the Hall sensor.
    Hall,
    /// By hand.
    At {
        /// Where the paddle stands, degrees.
        angle_deg: f32,
    },
}

/// What a line asks for. Numbers are in the unit that people see: degrees, or N m at the motor in torque mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// List of the commands.
    Help,
    /// One setting or all.
    Get(Option<&'static Field>),
    /// A setting and its value, within its bounds.
    Set(&'static Field, f32),
    /// Start to control.
    Arm(Mode),
    /// Motor off.
    Disarm,
    /// Zero of the encoder.
    Zero(Zero),
    /// Reference.
    Reference(f32),
    /// Test signal.
    Start(Excitation),
    /// End of the test signal.
    Stop,
    /// State of the controller.
    Status,
    /// The last faults.
    Faults,
    /// Let go of the fault.
    Clear,
    /// A program steers.
    Beat,
}

/// Why a line is no command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParseError {
    /// Longer than [`MAX_LINE_BYTES`].
    TooLong,
    /// Not plain text.
    NotText,
    /// The first word is no command.
    UnknownCommand,
    /// The words after the first do not fit.
    Usage(Usage),
    /// The setting is refused.
    Setting(SettingError),
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "line longer than {MAX_LINE_BYTES} characters"),
            Self::NotText => f.write_str("line is not plain text: check the baud rate"),
            Self::UnknownCommand => f.write_str("no such command: help lists them"),
            Self::Usage(Usage {
                name,
                arguments: "",
                ..
            }) => write!(f, "write {name} alone"),
            Self::Usage(Usage {
                name, arguments, ..
            }) => write!(f, "write {name} {arguments}"),
            Self::Setting(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ParseError {}

impl From<SettingError> for ParseError {
    fn from(error: SettingError) -> Self {
        Self::Setting(error)
    }
}

/// The command of a line; `None` for a blank one.
///
/// # Errors
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
    let mut words = line.split_ascii_whitespace();
    let Some(name) = words.next() else {
        return Ok(None);
    };
    let usage = COMMANDS
        .iter()
        .find(|usage| usage.name == name)
        .ok_or(ParseError::UnknownCommand)?;
    let mut arguments = Arguments {
        words,
        usage: *usage,
    };
    let command = match name {
        "help" => Command::Help,
        "get" => Command::Get(arguments.optional().map(Field::find).transpose()?),
        "set" => {
            let field = Field::find(arguments.word()?)?;
            Command::Set(field, field.parse(arguments.word()?)?)
        }
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
        "beat" => Command::Beat,
        _ => Command::Status,
    };
    if arguments.optional().is_some() {
        return Err(arguments.misused());
    }
    Ok(Some(command))
}

struct Arguments<'a> {
    words: core::str::SplitAsciiWhitespace<'a>,
    usage: Usage,
}

impl<'a> Arguments<'a> {
    fn misused(&self) -> ParseError {
        ParseError::Usage(self.usage)
    }

    fn optional(&mut self) -> Option<&'a str> {
        self.words.next()
    }

    fn word(&mut self) -> Result<&'a str, ParseError> {
        self.optional().ok_or(self.misused())
    }

    fn number(&mut self) -> Result<f32, ParseError> {
        let word = self.word()?;
        self.finite(word)
    }

    fn finite(&self, word: &str) -> Result<f32, ParseError> {
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
