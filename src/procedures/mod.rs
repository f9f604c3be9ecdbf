//! Procedures: the paddle measures itself, armed, within limits of its own, and off at their end whatever happens.
//!
//! ```text
//! friction           torque that just moves the paddle, both ways, at several angles
//! hall_calibration   the Hall sensor's curve against the encoder
//! motor              resistance and inductance of the winding, offset of the current
//! relay              ultimate gain and period, and the gains of Ziegler and Nichols
//! ```
//!
//! Each is advanced about once a millisecond, below the control loop.

mod fit;
mod friction;
mod hall_calibration;
mod motor;
mod relay;
mod winding;

pub use friction::{Friction, FrictionFinding};
pub use hall_calibration::{HallCalibration, HallFinding};
pub use motor::{MotorFinding, MotorId};
pub use relay::{RelayFinding, RelayTest};
pub use winding::Winding;

use core::fmt;

use crate::console::Device;
use crate::controller::Mode;
use crate::decimal::Fixed;
use crate::settings::{Sensor, Settings};
use crate::units::DEG_PER_RAD;

/// Which procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProcedureKind {
    /// [`Friction`].
    Friction,
    /// [`HallCalibration`].
    Hall,
    /// [`MotorId`].
    Motor,
    /// [`RelayTest`].
    ZieglerNichols,
}

impl ProcedureKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Hall => "hall cal",
            Self::Motor => "motor id",
            Self::ZieglerNichols => "zn",
        }
    }

    /// Longest time that it takes, s.
    pub const LONGEST_S: f32 = 60.0;

    /// Mode in which it works.
    pub fn mode(self) -> Mode {
        match self {
            Self::Motor => Mode::Torque,
            Self::Friction | Self::Hall | Self::ZieglerNichols => Mode::Position,
        }
    }

    /// The settings under which it works, from those of the user.
    pub fn settings(self, users: &Settings) -> Settings {
        let mut settings = *users;
        settings.estimate.sensor = Sensor::Encoder;
        settings.compensation.dry = false;
        settings.compensation.viscous = false;
        settings.compensation.gravity = false;
        match self {
            Self::Friction => friction::adapt(&mut settings),
            Self::Hall => hall_calibration::adapt(&mut settings),
            Self::Motor => {}
            Self::ZieglerNichols => relay::adapt(&mut settings),
        }
        settings
    }

    /// It, ready to begin, on a paddle with these settings of the user.
    pub fn begin(self, users: &Settings) -> Procedure {
        match self {
            Self::Friction => Procedure::Friction(Friction::new(users)),
            Self::Hall => Procedure::Hall(HallCalibration::new(users)),
            Self::Motor => Procedure::Motor(MotorId::new(users)),
            Self::ZieglerNichols => Procedure::ZieglerNichols(RelayTest::new(users)),
        }
    }
}

/// A procedure at work.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is no heap, and only one of them at a time"
)]
pub enum Procedure {
    /// [`Friction`].
    Friction(Friction),
    /// [`HallCalibration`].
    Hall(HallCalibration),
    /// [`MotorId`].
    Motor(MotorId),
    /// [`RelayTest`].
    ZieglerNichols(RelayTest),
}

/// How it ended.
pub type Outcome = Result<Finding, ProcedureError>;

impl Procedure {
    /// Which it is.
    pub fn kind(&self) -> ProcedureKind {
        match self {
            Self::Friction(_) => ProcedureKind::Friction,
            Self::Hall(_) => ProcedureKind::Hall,
            Self::Motor(_) => ProcedureKind::Motor,
            Self::ZieglerNichols(_) => ProcedureKind::ZieglerNichols,
        }
    }

    /// Goes on by `elapsed_s`, s, with a device that is armed; `None` until it has ended.
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        match self {
            Self::Friction(friction) => friction.advance(elapsed_s, device),
            Self::Hall(calibration) => calibration.advance(elapsed_s, device),
            Self::Motor(motor) => motor.advance(elapsed_s, device),
            Self::ZieglerNichols(relay) => relay.advance(elapsed_s, device),
        }
    }
}

/// What a procedure has found; its `Display` is a few lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// By [`Friction`].
    Friction(FrictionFinding),
    /// By [`HallCalibration`].
    Hall(HallFinding),
    /// By [`MotorId`].
    Motor(MotorFinding),
    /// By [`RelayTest`].
    ZieglerNichols(RelayFinding),
}

impl Finding {
    /// Puts what was calibrated into the settings. Gains and compensations are proposed only.
    pub fn take_over(&self, settings: &mut Settings) {
        match self {
            Self::Hall(finding) => settings.hall = finding.curve,
            Self::Motor(finding) => {
                settings.motor.resistance_ohm = finding.resistance_ohm;
                settings.motor.inductance_h = finding.inductance_h;
            }
            Self::Friction(_) | Self::ZieglerNichols(_) => {}
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Friction(finding) => finding.fmt(f),
            Self::Hall(finding) => finding.fmt(f),
            Self::Motor(finding) => finding.fmt(f),
            Self::ZieglerNichols(finding) => finding.fmt(f),
        }
    }
}

/// Why a procedure has found nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProcedureError {
    /// The paddle did not move.
    DoesNotMove {
        /// Under this torque, N m at the motor.
        torque_nm: f32,
    },
    /// Something is in the way.
    Blocked {
        /// At this angle, rad.
        angle_rad: f32,
    },
    /// The Hall sensor's curve turns back within the travel.
    NotMonotonic,
    /// The Hall sensor's voltage hardly changes.
    NoHallSignal,
    /// What was measured does not fit a winding.
    NoWinding,
    /// No oscillation that lasts.
    NoOscillation,
    /// The swing came too near to the ends.
    TooWide,
    /// It took too long.
    TooLong,
}

impl fmt::Display for ProcedureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DoesNotMove { torque_nm } => write!(
                f,
                "the paddle does not move under {} mN m at the motor: let it go, and check cable and screw",
                Fixed(torque_nm * 1e3, 1)
            ),
            Self::Blocked { angle_rad } => write!(
                f,
                "something is in the way at {} deg: let the paddle go, and zero it in the middle of its travel",
                Fixed(angle_rad * DEG_PER_RAD, 1)
            ),
            Self::NotMonotonic => f.write_str(
                "the Hall sensor's curve turns back within the travel: move the magnet, and begin again",
            ),
            Self::NoHallSignal => f.write_str(
                "the Hall sensor's voltage hardly changes: check its wire and its magnet",
            ),
            Self::NoWinding => f.write_str(
                "what was measured does not fit a winding: check the motor's wires, and motor.supply",
            ),
            Self::NoOscillation => f.write_str(
                "no oscillation that lasts: is the paddle free, and is its friction below a third of the relay's torque?",
            ),
            Self::TooWide => f.write_str("the paddle swings too wide for the relay: check motor.torque_constant"),
            Self::TooLong => f.write_str("it took longer than a minute"),
        }
    }
}

impl core::error::Error for ProcedureError {}
