//! A reading that stays amid a motion and then jumps to where that has gone.

use super::constant_segments::{BESIDE, ENTRY, constant_segments, typical_step};
use super::spikes::{SPIKE, usual};
use crate::statistics::{noise, smallest_step};
use crate::{Oddity, Run};
use std::ops::Range;

/// What freezes moves: over as many rows it has gone this many of the smallest steps, or of the noise, or as far as at an entry.
const MOVES: f64 = 3.0;
/// What a frozen reading jumps is this many times what the motion beside would have gone meanwhile, at most: more is counts that
/// were lost.
const CAUGHT_UP: f64 = 3.0;

/// Stretches amid a motion that end in a jump to where it has gone, and their rows but the first, which was read.
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
