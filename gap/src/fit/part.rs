//! Which windows of the data take part in a fit.

/// Which windows take part, by running index over all series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part<'a> {
    All,
    /// One of two halves.
    Half(bool),
    /// Those that are true here.
    Chosen(&'a [bool]),
}

impl Part<'_> {
    pub(crate) fn has(self, window: usize) -> bool {
        match self {
            Self::All => true,
            Self::Half(first) => (turn(window) < 0.5) == first,
            Self::Chosen(chosen) => chosen.get(window).copied().unwrap_or(false),
        }
    }
}

/// A number from 0 to 1 for each window, in a sequence that no period fits.
pub(crate) fn turn(window: usize) -> f64 {
    // The golden ratio's multiples are the sequence worst matched by any period.
    (window as f64 + 0.5) * 0.618_033_988_749_895 % 1.0
}
