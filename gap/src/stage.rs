//! What a diagnosis is at.

use std::fmt;

/// A part of a diagnosis that takes its time. Those that look for effects come once for every effect that is looked
/// for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Cuts the runs into windows and judges their noise.
    Windows,
    /// Moves the nominal model's numbers within their tolerances.
    Nominal,
    /// Tries every effect on a few windows.
    Screening,
    /// Fits the most promising effects to all windows.
    Finalists,
    /// Fits the best one to the end, and judges it on windows that it has not seen.
    Judging,
    /// Measures gap, floor and shrinks.
    Shrink,
    /// Finds the parts of the data that carry the gap.
    Where,
    /// Looks for the excitation that separates what is left.
    NextExperiment,
}

impl Stage {
    /// All, in the order in which a diagnosis first comes to them.
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
