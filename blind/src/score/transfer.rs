//! Compares a corrected model with recordings that it was not fitted to.

use serde::Serialize;

use super::judge::{FreshGaps, Outcome};
use super::summary::{Goal, Row};
use crate::diagnosis::Gap;

/// The shrink of a saved model on another recording of the same device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    /// Shrink on that recording. 1 = down to the gap of the true model.
    pub shrink: f64,
    /// This shrink over the claimed one. `None` if none was claimed.
    pub over_claimed: Option<f64>,
    /// Whether the claimed interval contains this shrink. `None` if no interval was claimed.
    pub interval_holds: Option<bool>,
}

impl Kept {
    /// Compares the claims of `gap` with `measured`. Returns `None` if the nominal gap is not above the floor.
    pub(super) fn of(gap: &Gap, measured: FreshGaps, floor: f64) -> Option<Self> {
        let shrink = measured.shrink(floor)?;
        let over_claimed = gap.shrink.filter(|claimed| *claimed > 0.0);
        Some(Self {
            shrink,
            over_claimed: over_claimed.map(|claimed| shrink / claimed),
            // The true model has a shrink of 1. Noise may let a model exceed it slightly.
            interval_holds: gap
                .shrink_interval
                .map(|[low, high]| (low..=high).contains(&shrink.min(1.0))),
        })
    }
}

/// Rows on the claimed intervals, for messy cases and for recordings with another excitation, amplitude and load.
pub(super) fn rows(outcomes: &[Outcome]) -> Vec<Row> {
    let holds = |kept: Vec<Kept>| kept.into_iter().filter_map(|kept| kept.interval_holds);
    let mut rows = Vec::new();
    let fresh: Vec<Kept> = outcomes.iter().filter_map(|o| o.fresh).collect();
    if !fresh.is_empty() {
        rows.push(Row::at_least(
            "95 % shrink intervals that hold on fresh data",
            0.95,
            holds(fresh),
        ));
    }
    let transfer: Vec<Kept> = outcomes.iter().filter_map(|o| o.transfer).collect();
    if !transfer.is_empty() {
        let over = transfer.iter().filter_map(|kept| kept.over_claimed);
        let over: Vec<f64> = over.collect();
        rows.extend([
            Row::quantile(
                "transfer: shrink over the claimed one, median",
                Goal::AtLeast(0.7),
                over.clone(),
                0.5,
            ),
            Row::quantile(
                "transfer: shrink over the claimed one, worst",
                Goal::AtLeast(0.0),
                over,
                0.0,
            ),
            Row::at_least(
                "transfer: 95 % shrink intervals that hold",
                0.95,
                holds(transfer),
            ),
        ]);
    }
    rows
}
