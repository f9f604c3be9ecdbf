//! Why the bridge is off.

use core::fmt;

/// Why the bridge has no duty until somebody clears it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// Encoder and Hall sensor disagree for too long.
    SensorDisagreement,
    /// The Hall sensor's converter is at an end of its range.
    HallSignal,
    /// The Hall sensor sees motion and the encoder none.
    EncoderStill,
    /// The paddle turns too fast.
    Overspeed,
    /// The paddle is outside its travel.
    Travel,
    /// The motor pushes with all its torque, and the paddle does not move.
    Stall,
    /// The motor current is too high.
    Overcurrent,
    /// The current's reading is at an end of its range.
    CurrentSignal,
    /// The current is not what the motor makes of the voltage.
    CurrentMismatch,
    /// Results of the current's converter were lost.
    Converter,
    /// The motor's winding is too hot, by the current that it carried.
    MotorHeat,
    /// The bridge is too hot, by the current that it carried.
    BridgeHeat,
    /// A measurement or a result is not a finite number.
    NonFinite,
    /// The H-bridge reports a fault (nFAULT).
    Bridge,
    /// A control tick was missed or came too late.
    Deadline,
    /// The chip's own supply fell.
    Supply,
    /// The program that has the paddle armed has gone silent.
    HostSilent,
}

impl Fault {
    /// All of them, in the order of their numbers.
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
