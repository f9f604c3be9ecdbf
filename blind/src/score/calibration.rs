//! Whether a stated confidence is the share of those that are right.

use serde::Serialize;

use super::Outcome;
use super::judge::CONFIDENT;

/// Edges of the bins.
const EDGES: [f64; 7] = [0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0];

/// Names given with a confidence in one stretch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// From this confidence on.
    pub from: f64,
    /// Up to this one, which only the last bin includes.
    pub to: f64,
    /// How many names.
    pub given: usize,
    /// How many of them are right.
    pub right: usize,
    /// Their mean confidence; 0 of none.
    pub mean_confidence: f64,
}

impl Bin {
    fn of(from: f64, to: f64, confidences: impl Iterator<Item = (f64, bool)>) -> Self {
        let (mut given, mut right, mut sum) = (0, 0, 0.0);
        for (confidence, is_right) in confidences {
            given += 1;
            right += usize::from(is_right);
            sum += confidence;
        }
        Self {
            from,
            to,
            given,
            right,
            mean_confidence: sum / f64::max(given as f64, 1.0),
        }
    }
}

/// The bins, and all confident names together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// By confidence.
    pub bins: Vec<Bin>,
    /// All with 0.9 and above.
    pub confident: Bin,
}

impl Calibration {
    /// Over every name in `outcomes`.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let within = |from: f64, to: f64| {
            let all = outcomes
                .iter()
                .flat_map(|outcome| outcome.confidences.iter().copied());
            Bin::of(
                from,
                to,
                all.filter(move |(c, _)| *c >= from && (*c < to || to >= 1.0)),
            )
        };
        Self {
            bins: EDGES
                .windows(2)
                .map(|edges| within(edges[0], edges[1]))
                .collect(),
            confident: within(CONFIDENT, 1.0),
        }
    }
}
