//! Selects the windows that take part in a fit.

/// The windows that take part, by running index over all series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part<'a> {
    All,
    /// One of two halves of the windows.
    Half(bool),
    /// The windows whose entry is true.
    Chosen(&'a [bool]),
}

impl Part<'_> {
    pub(crate) fn has(self, window: usize) -> bool {
        match self {
            Self::All => true,
            Self::Half(first) => (quasi_random(window) < 0.5) == first,
            Self::Chosen(chosen) => chosen.get(window).copied().unwrap_or(false),
        }
    }
}

/// A number from 0 to 1 for each window, from a low-discrepancy sequence without a period.
pub(crate) fn quasi_random(window: usize) -> f64 {
    // Multiples of the golden ratio modulo 1 match no period.
    (window as f64 + 0.5) * 0.618_033_988_749_895 % 1.0
}
