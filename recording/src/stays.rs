//! A reading that stays while the device moves on.

use crate::inspect::{SPIKE, usual};
use crate::statistics::{extremes, median, quantile};
use crate::{Oddity, Run};

/// Saturation: the longest stay on an extreme has this share of the run's samples.
const STAY: f64 = 0.02;
/// During the stay the input spans this share of its whole span.
const STAY_INPUT: f64 = 0.25;
/// The stay begins at this share of the median step while moving: a sensor clips abruptly, a rest is eased into.
const STAY_ENTRY: f64 = 0.5;
/// Rows of a stay at least, and over which the motion beside it is seen although a counter is slow for it.
const BESIDE: usize = 10;
/// What a frozen reading jumps is this many times what the motion beside would have gone meanwhile, at most: more is counts that
/// were lost.
const CAUGHT_UP: f64 = 3.0;
/// Repeated: fewer changes than this share follow one another from row to row.
const NEXT_ROW: f64 = 0.05;
/// And most of them are this many times the smallest ones, so that it is no counter that the device is slow for.
const BEYOND_COUNTS: f64 = 2.0;
/// Smallest ones.
const SMALL: f64 = 0.1;
/// Fewest changes that tell a pattern.
const FEWEST_CHANGES: usize = 20;

/// A stay on an extreme that is come to amid a motion.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
pub(crate) fn saturated(run: &Run) -> Option<Oddity> {
    let (low, high) = extremes(&run.position);
    let (least_input, most_input) = extremes(&run.input);
    let typical_step = typical_step(&run.position, 1);
    [low, high].into_iter().find_map(|value| {
        let (from, to) = longest_stay(&run.position, value)?;
        let (least, most) = extremes(&run.input[from..to]);
        let entry = (run.position.get(from.checked_sub(2)?)? - run.position.get(from - 1)?).abs();
        let clipped = (to - from) as f64 >= STAY * run.len() as f64
            && most - least >= STAY_INPUT * (most_input - least_input)
            && most > least
            && entry >= STAY_ENTRY * typical_step;
        let stay_s = run.time[to - 1] - run.time[from];
        clipped.then(|| Oddity::Saturated {
            file: run.file.clone(),
            value,
            from_s: run.time[from],
            stay_s,
        })
    })
}

/// First and one past the last index of the longest stretch of `value`.
fn longest_stay(column: &[f64], value: f64) -> Option<(usize, usize)> {
    stays(column)
        .filter(|(from, _)| column[*from] == value)
        .max_by_key(|(from, to)| to - from)
}

/// First and one past the last index of each stretch of one value.
fn stays(column: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    let mut end = 0;
    column.chunk_by(|a, b| a == b).map(move |stay| {
        end += stay.len();
        (end - stay.len(), end)
    })
}

/// Median step over some rows where there is one.
fn typical_step(column: &[f64], rows: usize) -> f64 {
    let steps = column
        .windows(rows + 1)
        .map(|some| (some[rows] - some[0]).abs());
    median(steps.filter(|step| *step > 0.0).collect())
}

/// Stretches amid a motion that end in a jump to where it has gone.
#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
pub(crate) fn frozen(run: &Run) -> Option<Oddity> {
    let x = &run.position;
    let long = stays(x).filter(|(from, to)| to - from >= BESIDE);
    let long: Vec<(usize, usize)> = long.collect();
    if long.is_empty() {
        return None;
    }
    let (usual, typical_step) = (usual(x), typical_step(x, BESIDE));
    let is_frozen = |&(from, to): &(usize, usize)| {
        let before = from.checked_sub(BESIDE + 1).map(|first| &x[first..from]);
        let (Some(before), Some(after)) = (before, x.get(to..=to + BESIDE)) else {
            return false;
        };
        let jump = (after[0] - x[from]).abs();
        let steps = after[..3].windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let gone = |some: &[f64]| (some[BESIDE] - some[0]).abs();
        let meanwhile = gone(before).max(gone(after)) * (to - from) as f64 / BESIDE as f64;
        jump > SPIKE * steps.fold(usual, f64::max)
            && jump <= CAUGHT_UP * meanwhile
            && gone(before) >= STAY_ENTRY * typical_step
    };
    let frozen: Vec<(usize, usize)> = long.into_iter().filter(is_frozen).collect();
    let lasts_s = |&(from, to): &(usize, usize)| run.time[to] - run.time[from];
    let longest = frozen.iter().copied();
    let longest = longest.max_by(|a, b| lasts_s(a).total_cmp(&lasts_s(b)))?;
    Some(Oddity::FrozenPosition {
        file: run.file.clone(),
        count: frozen.len(),
        from_s: run.time[longest.0],
        stay_s: lasts_s(&longest),
    })
}

/// The rows in which the position is new, where the others repeat the one before: it is read less often than it is logged.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
pub(crate) fn fresh_rows(run: &Run) -> Option<(Oddity, Vec<usize>)> {
    let x = &run.position;
    let changes: Vec<usize> = (1..x.len()).filter(|&row| x[row] != x[row - 1]).collect();
    if changes.len() < FEWEST_CHANGES {
        return None;
    }
    let apart = || changes.windows(2).map(|pair| pair[1] - pair[0]);
    let next_row = apart().filter(|rows| *rows == 1).count() as f64;
    let steps: Vec<f64> = changes
        .iter()
        .map(|&row| (x[row] - x[row - 1]).abs())
        .collect();
    let small = quantile(steps.clone(), SMALL);
    if next_row > NEXT_ROW * changes.len() as f64 || median(steps) < BEYOND_COUNTS * small {
        return None;
    }
    let mut apart: Vec<usize> = apart().collect();
    let middle = apart.len() / 2;
    let every = *apart.select_nth_unstable(middle).1;
    // At rest what is new is the same.
    let mut fresh = vec![0];
    for row in 1..x.len() {
        let last = fresh[fresh.len() - 1];
        if x[row] != x[row - 1] || row - last >= every {
            fresh.push(row);
        }
    }
    let oddity = Oddity::Repeated {
        file: run.file.clone(),
        every,
    };
    Some((oddity, fresh))
}
