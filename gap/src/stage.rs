//! The stages of a diagnosis, for a progress display.

use std::fmt;

/// A stage of a diagnosis that takes noticeable time. The stages that search effects are repeated for pairs of
/// effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Divides the runs into windows and estimates their noise.
    Windows,
    /// Fits the parameters of the nominal model within their tolerances.
    Nominal,
    /// Tries every effect on a few windows.
    Screening,
    /// Fits the most promising effects to all windows.
    Finalists,
    /// Completes the fit of the best effect, and evaluates it on held-out windows.
    Judging,
    /// Measures the gap, its floor and the shrink.
    Shrink,
    /// Locates the gap in the data.
    Where,
    /// Searches the excitation that distinguishes the remaining rivals.
    NextExperiment,
}

impl Stage {
    /// All stages, in the order in which a diagnosis first reaches them.
    pub const ALL: [Self; 8] = [
        Self::Windows,
        Self::Nominal,
        Self::Screening,
        Self::Finalists,
        Self::Judging,
        Self::Shrink,
        Self::Where,
        Self::NextExperiment,
    ];
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Windows => "cutting windows",
            Self::Nominal => "fitting the nominal model",
            Self::Screening => "screening effects",
            Self::Finalists => "fitting the most promising effects",
            Self::Judging => "judging the best one",
            Self::Shrink => "measuring the shrink",
            Self::Where => "locating the gap",
            Self::NextExperiment => "choosing the next experiment",
        })
    }
}
