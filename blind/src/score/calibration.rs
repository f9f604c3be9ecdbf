//! Compares stated confidences with the share of right names.

use serde::Serialize;

use super::Outcome;
use super::judge::CONFIDENT;

/// Edges of the confidence bins.
const EDGES: [f64; 7] = [0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0];

/// The names whose confidence lies in one interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Lower end of the interval, included.
    pub from: f64,
    /// Upper end of the interval. Only the last bin includes it.
    pub to: f64,
    /// Number of names.
    pub given: usize,
    /// Number of right names.
    pub right: usize,
    /// Mean confidence of the names. 0 if there are none.
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
    /// The bins in the order of confidence.
    pub bins: Vec<Bin>,
    /// All names with a confidence of 0.9 or more.
    pub confident: Bin,
}

impl Calibration {
    /// The calibration of all names in `outcomes`.
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
