//! Constant segments: stretches of rows with one value, which a sensor may show while the device moves on.

use crate::statistics::median;
use std::ops::Range;

/// Step before a segment of a sensor that clips, over the median step while moving: clipping is abrupt, a device comes to rest slowly.
pub(crate) const ENTRY: f64 = 0.5;
/// Fewest rows of a segment. The motion before and after it is measured over as many rows, so that a slow counter shows it.
pub(crate) const BESIDE: usize = 10;

/// The rows of each segment of one value.
pub(crate) fn constant_segments(column: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    column.chunk_by(|a, b| a == b).map(move |segment| {
        end += segment.len();
        end - segment.len()..end
    })
}

/// Median of the steps over `rows` rows that are not zero.
pub(crate) fn typical_step(column: &[f64], rows: usize) -> f64 {
    let steps = column
        .windows(rows + 1)
        .map(|some| (some[rows] - some[0]).abs());
    median(steps.filter(|step| *step > 0.0).collect())
}
