//! Constant segments: consecutive rows with the same value. A sensor can show one while the device moves.

use crate::statistics::median;
use std::ops::Range;

/// Least step before a segment of a clipping sensor, over the median step during motion. Clipping is abrupt, while a device
/// comes to rest gradually.
pub(crate) const ENTRY: f64 = 0.5;
/// Fewest rows of a segment. The motion before and after it is measured over the same number of rows, so that slow motion of
/// a counter is detected.
pub(crate) const BESIDE: usize = 10;

/// The rows of each segment of one value.
pub(crate) fn constant_segments(column: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    column.chunk_by(|a, b| a == b).map(move |segment| {
        end += segment.len();
        end - segment.len()..end
    })
}

/// Median of the non-zero changes over `rows` rows.
pub(crate) fn typical_step(column: &[f64], rows: usize) -> f64 {
    let steps = column
        .windows(rows + 1)
        .map(|some| (some[rows] - some[0]).abs());
    median(steps.filter(|step| *step > 0.0).collect())
}
