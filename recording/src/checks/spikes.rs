//! Spikes: single samples far from both their neighbours.

use crate::statistics::{quantile, smallest_step};
use crate::{Oddity, Run};
use std::ops::Range;

/// Least distance of a spike from the mean of its neighbours, over the changes between the neighbouring samples, over the
/// usual distance, and over the smallest steps.
pub(crate) const SPIKE: f64 = 8.0;
/// Share of samples that defines the usual distance.
const MOST: f64 = 0.9;

/// Finds the spikes. Returns the oddity and their rows.
pub(crate) fn spikes(run: &Run) -> Option<(Oddity, Vec<Range<usize>>)> {
    let x = &run.position;
    let usual = usual(x);
    let is_spike = |five: &[f64]| {
        let near = [five[1] - five[0], five[3] - five[1], five[4] - five[3]];
        let near = near.iter().fold(usual, |most, step| step.abs().max(most));
        beside(five) > SPIKE * near
    };
    let spikes = x.windows(5).enumerate().filter(|(_, five)| is_spike(five));
    let spikes: Vec<(usize, f64)> = spikes.map(|(i, five)| (i + 2, beside(five))).collect();
    let &(at, farthest) = spikes.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let oddity = Oddity::Spikes {
        file: run.file.clone(),
        count: spikes.len(),
        farthest,
        at_s: run.time[at],
    };
    let rows = spikes.into_iter().map(|(row, _)| row..row + 1);
    Some((oddity, rows.collect()))
}

/// Distance of sample `five[2]` from the mean of its neighbours.
fn beside(five: &[f64]) -> f64 {
    (five[2] - 0.5 * (five[1] + five[3])).abs()
}

/// Usual distance of a sample from the mean of its neighbours. It is at least one of the smallest steps.
pub(crate) fn usual(x: &[f64]) -> f64 {
    quantile(x.windows(5).map(beside).collect(), MOST).max(smallest_step(x))
}
