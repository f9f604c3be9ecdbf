//! What a corrected model is worth on data that it was not made for.

use serde::Serialize;

use super::judge::{FreshGaps, Outcome};
use super::summary::{Goal, Row};
use crate::diagnosis::Gap;

/// A model that was saved from one recording, on another one of the same device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    /// Shrink on that other recording: to what the truth leaves of it, 1 = all the way.
    pub shrink: f64,
    /// That over the claimed one; `None` if none was claimed.
    pub over_claimed: Option<f64>,
    /// Whether it lies within the interval that was claimed; `None` if none was.
    pub interval_holds: Option<bool>,
}

impl Kept {
    /// What is kept of what `gap` claims; `None` if there is nothing to close.
    pub(super) fn of(gap: &Gap, measured: FreshGaps, floor: f64) -> Option<Self> {
        let shrink = measured.shrink(floor)?;
        let over_claimed = gap.shrink.filter(|claimed| *claimed > 0.0);
        Some(Self {
            shrink,
            over_claimed: over_claimed.map(|claimed| shrink / claimed),
            // The truth itself is no better than 1, and noise may bring a model a little beyond.
            interval_holds: gap
                .shrink_interval
                .map(|[low, high]| (low..=high).contains(&shrink.min(1.0))),
        })
    }
}

/// Rows on the intervals that were claimed on messy cases, and on recordings with another excitation, amplitude and load.
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
