//! Why the board began anew.

use core::fmt;

/// Cause of the last reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// The supply came.
    Power,
    /// The supply fell below the brown-out level.
    BrownOut,
    /// The reset pin, or a debug probe by it.
    Pin,
    /// The program asked for it.
    Software,
    /// The program was stuck, or stopped after a failure.
    Watchdog,
}

impl fmt::Display for ResetCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Power => "power-on",
            Self::BrownOut => "the supply below its brown-out level",
            Self::Pin => "the reset pin",
            Self::Software => "a request of the program",
            Self::Watchdog => "the watchdog",
        })
    }
}
