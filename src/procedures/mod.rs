//! Procedures by which the paddle measures itself. They run armed, within their own limits, and end with the motor off.
//!
//! ```text
//! friction           torque that just moves the paddle, both ways, at several angles
//! hall_calibration   the Hall sensor's curve against the encoder
//! motor              resistance and inductance of the winding, offset of the current
//! relay              ultimate gain and period, and the gains of Ziegler and Nichols
//! ```
//!
//! The console advances a procedure about once per millisecond, at a lower priority than the control loop.

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

/// Identifies a procedure.
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
    /// Name of the procedure.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Hall => "hall cal",
            Self::Motor => "motor id",
            Self::ZieglerNichols => "zn",
        }
    }

    /// Time limit of a procedure, s.
    pub const LONGEST_S: f32 = 60.0;

    /// Controller mode in which the procedure runs.
    pub fn mode(self) -> Mode {
        match self {
            Self::Motor => Mode::Torque,
            Self::Friction | Self::Hall | Self::ZieglerNichols => Mode::Position,
        }
    }

    /// Settings during the procedure, derived from the user's settings.
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

    /// Creates the procedure with the user's settings.
    pub fn begin(self, users: &Settings) -> Procedure {
        match self {
            Self::Friction => Procedure::Friction(Friction::new(users)),
            Self::Hall => Procedure::Hall(HallCalibration::new(users)),
            Self::Motor => Procedure::Motor(MotorId::new(users)),
            Self::ZieglerNichols => Procedure::ZieglerNichols(RelayTest::new(users)),
        }
    }
}

/// A running procedure.
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

/// Result of a procedure.
pub type Outcome = Result<Finding, ProcedureError>;

impl Procedure {
    /// Which procedure it is.
    pub fn kind(&self) -> ProcedureKind {
        match self {
            Self::Friction(_) => ProcedureKind::Friction,
            Self::Hall(_) => ProcedureKind::Hall,
            Self::Motor(_) => ProcedureKind::Motor,
            Self::ZieglerNichols(_) => ProcedureKind::ZieglerNichols,
        }
    }

    /// Advances the procedure by `elapsed_s`, s, with an armed device. Returns `None` until it has ended.
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        match self {
            Self::Friction(friction) => friction.advance(elapsed_s, device),
            Self::Hall(calibration) => calibration.advance(elapsed_s, device),
            Self::Motor(motor) => motor.advance(elapsed_s, device),
            Self::ZieglerNichols(relay) => relay.advance(elapsed_s, device),
        }
    }
}

/// The finding of a procedure. Its `Display` is a few lines of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// Result of [`Friction`].
    Friction(FrictionFinding),
    /// Result of [`HallCalibration`].
    Hall(HallFinding),
    /// Result of [`MotorId`].
    Motor(MotorFinding),
    /// Result of [`RelayTest`].
    ZieglerNichols(RelayFinding),
}

impl Finding {
    /// Writes calibrated values into the settings. Gains and compensations are proposed only.
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

/// Why a procedure has no finding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProcedureError {
    /// The paddle did not move.
    DoesNotMove {
        /// The applied torque, N m at the motor.
        torque_nm: f32,
    },
    /// An obstacle blocks the paddle.
    Blocked {
        /// The angle of the obstacle, rad.
        angle_rad: f32,
    },
    /// The curve of the Hall sensor is not monotonic within the travel.
    NotMonotonic,
    /// The voltage of the Hall sensor hardly changes.
    NoHallSignal,
    /// The measured currents do not fit the model of a winding.
    NoWinding,
    /// There is no steady oscillation.
    NoOscillation,
    /// The oscillation came too close to the ends of the travel.
    TooWide,
    /// The procedure exceeded its time limit.
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
