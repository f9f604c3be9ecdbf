//! Frozen readings: constant segments within a motion that end with a jump to the true position.

use super::constant_segments::{BESIDE, ENTRY, constant_segments, typical_step};
use super::spikes::{SPIKE, usual};
use crate::statistics::{noise, smallest_step};
use crate::{Oddity, Run};
use std::ops::Range;

/// Least motion before a frozen segment, in multiples of the smallest step or of the noise. A fast motion may also be judged
/// by [`ENTRY`].
const MOVES: f64 = 3.0;
/// Largest jump at the end of a frozen segment, over the motion extrapolated from before and after it. A larger jump means
/// lost counts.
const CAUGHT_UP: f64 = 3.0;

/// Finds the frozen segments. Returns the oddity and their rows, except the first row of each, which is valid.
#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
pub(crate) fn frozen(run: &Run) -> Option<(Oddity, Vec<Range<usize>>)> {
    let x = &run.position;
    let long = constant_segments(x).filter(|stay| stay.len() >= BESIDE);
    let long: Vec<Range<usize>> = long.collect();
    if long.is_empty() {
        return None;
    }
    let usual = usual(x);
    let seen = MOVES * smallest_step(x).max(noise(x));
    let least_gone = seen.min(ENTRY * typical_step(x, BESIDE));
    let is_frozen = |stay: &Range<usize>| {
        let (from, to) = (stay.start, stay.end);
        let before = from.checked_sub(BESIDE + 1).map(|first| &x[first..from]);
        let (Some(before), Some(after)) = (before, x.get(to..=to + BESIDE)) else {
            return false;
        };
        let jump = (after[0] - x[from]).abs();
        let steps = after[..3].windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let gone = |some: &[f64]| (some[BESIDE] - some[0]).abs();
        let meanwhile = gone(before).max(gone(after)) * stay.len() as f64 / BESIDE as f64;
        jump > SPIKE * steps.fold(usual, f64::max)
            && jump <= CAUGHT_UP * meanwhile
            && gone(before) >= least_gone
    };
    let frozen: Vec<Range<usize>> = long.into_iter().filter(is_frozen).collect();
    let lasts_s = |stay: &Range<usize>| run.time[stay.end] - run.time[stay.start];
    let longest = frozen
        .iter()
        .max_by(|a, b| lasts_s(a).total_cmp(&lasts_s(b)))?;
    let oddity = Oddity::FrozenPosition {
        file: run.file.clone(),
        count: frozen.len(),
        from_s: run.time[longest.start],
        stay_s: lasts_s(longest),
    };
    let rows = frozen.into_iter().map(|stay| stay.start + 1..stay.end);
    Some((oddity, rows.collect()))
}
