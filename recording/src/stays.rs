//! Readings that stay where they are while the device moves on.

use crate::statistics::median;
use std::ops::Range;

/// A stay begins at this share of the median step while moving: a sensor clips abruptly, a rest is eased into.
pub(crate) const ENTRY: f64 = 0.5;
/// Rows of a stay at least, and over which the motion beside it is seen although a counter is slow for it.
pub(crate) const BESIDE: usize = 10;

/// The rows of each stretch of one value.
pub(crate) fn stays(column: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    column.chunk_by(|a, b| a == b).map(move |stay| {
        end += stay.len();
        end - stay.len()..end
    })
}

/// Median step over some rows where there is one.
pub(crate) fn typical_step(column: &[f64], rows: usize) -> f64 {
    let steps = column
        .windows(rows + 1)
        .map(|some| (some[rows] - some[0]).abs());
    median(steps.filter(|step| *step > 0.0).collect())
}
