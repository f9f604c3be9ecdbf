//! Faults, which turn the bridge off.

use core::fmt;

/// A fault. The bridge stays off until it is cleared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// Encoder and Hall sensor disagreed for too long.
    SensorDisagreement,
    /// The result of the Hall sensor's converter is at an end of its range.
    HallSignal,
    /// The Hall sensor shows motion and the encoder does not.
    EncoderStill,
    /// The paddle exceeded its speed limit.
    Overspeed,
    /// The paddle is outside its travel.
    Travel,
    /// The motor has its full torque and the paddle does not move.
    Stall,
    /// The motor current is too high.
    Overcurrent,
    /// The current reading is at an end of its range.
    CurrentSignal,
    /// The current does not match the voltage and the model of the motor.
    CurrentMismatch,
    /// Results of the current's converter were lost.
    Converter,
    /// The estimated winding temperature is too high.
    MotorHeat,
    /// The estimated bridge temperature is too high.
    BridgeHeat,
    /// A measurement or a result is not a finite number.
    NonFinite,
    /// The H-bridge reports a fault (nFAULT).
    Bridge,
    /// A control tick was missed or came too late.
    Deadline,
    /// The supply of the chip fell too low.
    Supply,
    /// A host program with heartbeats fell silent while the paddle was armed.
    HostSilent,
}

impl Fault {
    /// All faults in the order of their numbers.
    pub const ALL: [Self; 17] = [
        Self::SensorDisagreement,
        Self::HallSignal,
        Self::EncoderStill,
        Self::Overspeed,
        Self::Travel,
        Self::Stall,
        Self::Overcurrent,
        Self::CurrentSignal,
        Self::CurrentMismatch,
        Self::Converter,
        Self::MotorHeat,
        Self::BridgeHeat,
        Self::NonFinite,
        Self::Bridge,
        Self::Deadline,
        Self::Supply,
        Self::HostSilent,
    ];
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SensorDisagreement => {
                "encoder and Hall sensor disagree: zero again, or calibrate the Hall sensor"
            }
            Self::HallSignal => "Hall signal at the end of its range: check its wire",
            Self::EncoderStill => {
                "the Hall sensor sees motion and the encoder none: check the encoder's wires, and the cable"
            }
            Self::Overspeed => "paddle too fast: lower the gains, or raise limit.speed",
            Self::Travel => "paddle outside its travel: bring it back, or zero again",
            Self::Stall => {
                "the motor pushes with all its torque and nothing moves: free the paddle, or move it away from its stop"
            }
            Self::Overcurrent => {
                "motor current too high: look for a short circuit, or lower motor.bandwidth"
            }
            Self::CurrentSignal => {
                "current reading at the end of its range: look for a short circuit, or check the shunt amplifier"
            }
            Self::CurrentMismatch => {
                "the current does not follow the voltage: check the motor wires, the shunt amplifier and the 24 V supply"
            }
            Self::Converter => {
                "the current's converter lost samples: clear begins anew; if it comes again, reset the board"
            }
            Self::MotorHeat => "the motor carried too much current for too long: let it cool",
            Self::BridgeHeat => "the bridge carried too much current for too long: let it cool",
            Self::NonFinite => "a number is not finite: correct the last setting, or reset the board",
            Self::Bridge => "H-bridge fault (nFAULT): check supply, temperature and motor wires",
            Self::Deadline => {
                "control stood still or came late: was a debugger attached? else lower the load of the processor"
            }
            Self::Supply => "the 3.3 V supply fell: check it, and what hangs on it",
            Self::HostSilent => {
                "the program that steers the paddle has gone silent: start it again, or set host.heartbeat 0"
            }
        })
    }
}
