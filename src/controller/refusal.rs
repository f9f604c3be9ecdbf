//! Why the controller refuses a request.

use core::fmt;

use crate::decimal::Fixed;
use crate::safety::Fault;
use crate::sensing::current::OffsetError;
use crate::wiring::WiringError;

/// Why arming is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArmError {
    /// The board's crystal did not start.
    NoCrystal,
    /// The current amplifier cannot be calibrated.
    Offset(OffsetError),
    /// This fault is still latched.
    Faulted(Fault),
    /// The wiring check failed.
    Wiring(WiringError),
    /// The measured winding resistance does not match the settings.
    Resistance {
        /// Measured resistance, ohm.
        measured_ohm: f32,
        /// Resistance in the settings, ohm.
        expected_ohm: f32,
    },
    /// The bridge reports a fault.
    BridgeNotReady,
    /// The controller is armed already.
    AlreadyArmed,
    /// No measurement has been made yet.
    NothingMeasured,
    /// The zero of the encoder is not set.
    NotZeroed,
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCrystal => f.write_str(
                "the crystal does not start, the clocks are not exact: reset the board, or replace the crystal",
            ),
            Self::Offset(error) => error.fmt(f),
            Self::Wiring(error) => error.fmt(f),
            Self::Resistance {
                measured_ohm,
                expected_ohm,
            } => write!(
                f,
                "the motor's winding has {} ohm, not {}: check the motor, its wires and the 24 V supply, or set \
                 motor.resistance",
                Fixed(*measured_ohm, 1),
                Fixed(*expected_ohm, 1)
            ),
            Self::Faulted(fault) => write!(f, "fault latched, mend and clear it: {fault}"),
            Self::BridgeNotReady => f.write_str(
                "the bridge reports a fault (nFAULT): is its 24 V supply on? check temperature and motor wires",
            ),
            Self::AlreadyArmed => f.write_str("armed already: disarm first"),
            Self::NothingMeasured => {
                f.write_str("nothing measured yet: is the control loop running?")
            }
            Self::NotZeroed => f.write_str("the encoder has no zero: use zero, or zero hall"),
        }
    }
}

impl core::error::Error for ArmError {}

/// Why setting the zero is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroError {
    /// The controller is armed.
    Armed,
    /// No measurement has been made yet.
    NothingMeasured,
    /// The angle is not within the travel.
    OutsideTravel,
    /// The Hall sensor's converter is at an end of its range.
    HallSignal,
}

impl fmt::Display for ZeroError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Armed => "disarm before zeroing",
            Self::NothingMeasured => "nothing measured yet: is the control loop running?",
            Self::OutsideTravel => "the angle is outside limit.travel",
            Self::HallSignal => {
                "Hall signal at the end of its range: check its wire, or zero by hand"
            }
        })
    }
}

impl core::error::Error for ZeroError {}

/// Why a reference is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceError {
    /// The controller is off.
    Disarmed,
    /// The value exceeds the travel or the torque limit, or is not a number.
    OutOfRange,
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Disarmed => "arm before setting a reference",
            Self::OutOfRange => "the reference is beyond limit.travel or motor.torque_limit",
        })
    }
}

impl core::error::Error for ReferenceError {}
