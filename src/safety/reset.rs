//! Causes of a reset.

use core::fmt;

/// Cause of the last reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// Power-on.
    Power,
    /// The supply fell below the brown-out level.
    BrownOut,
    /// The reset pin was pulled low, for example by a debug probe.
    Pin,
    /// The program requested it.
    Software,
    /// The watchdog expired: the program was stuck or had stopped after a failure.
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
