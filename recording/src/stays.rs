//! A reading that stays while the device moves on.

use crate::spikes::{SPIKE, usual};
use crate::statistics::{extremes, median, noise, smallest_step};
use crate::{Oddity, Run};
use std::ops::Range;

/// Saturation: the stays on an extreme, or the longest, have this share of the run's samples.
const STAY: f64 = 0.02;
/// During the stay the input spans this share of its whole span.
const STAY_INPUT: f64 = 0.25;
/// The stay begins at this share of the median step while moving: a sensor clips abruptly, a rest is eased into.
const STAY_ENTRY: f64 = 0.5;
/// A motion is seen once it has gone this many of the smallest steps, or of the noise; within so many rows, or it is a creep.
const SEEN: f64 = 10.0;
const MOST_BESIDE: usize = 4 * BESIDE;
/// By half of that time it has gone this share of it at least, where it was at speed from the first: half of it, and a quarter
/// where it is pushed from rest.
const AT_SPEED: f64 = 0.4;
/// Rows of a stay at least, and over which the motion beside it is seen although a counter is slow for it.
const BESIDE: usize = 10;
/// What freezes moves: over as many rows it has gone this many of the smallest steps, or of the noise, or as far as at an entry.
const MOVES: f64 = 3.0;
/// What a frozen reading jumps is this many times what the motion beside would have gone meanwhile, at most: more is counts that
/// were lost.
const CAUGHT_UP: f64 = 3.0;
/// Repeated: fewer changes than this share follow one another from row to row.
const NEXT_ROW: f64 = 0.05;
/// And most of them are this many times the smallest ones, so that it is no counter that the device is slow for.
const BEYOND_COUNTS: f64 = 2.0;
/// Fewest changes that tell a pattern.
const FEWEST_CHANGES: usize = 20;

/// Extremes at which a run shows its sensor to saturate: the motion goes on beyond, as fast as it comes and comes back.
#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
pub(crate) fn limits(run: &Run) -> impl Iterator<Item = f64> {
    let x = &run.position;
    let (low, high) = extremes(x);
    let seen = SEEN * smallest_step(x).max(noise(x));
    let is_passed = move |stay: Range<usize>| {
        let before = |rows: usize| x.get(stay.start.checked_sub(rows)?);
        let after = |rows: usize| x.get(stay.end - 1 + rows);
        is_at_speed(x, &stay, seen, before) && is_at_speed(x, &stay, seen, after)
    };
    let is_often = move |value| {
        let rows: usize = at(x, value).map(|stay| stay.len()).sum();
        rows as f64 >= STAY * x.len() as f64
    };
    let extremes = [low, high].into_iter();
    extremes.filter(move |&value| is_often(value) && at(x, value).any(is_passed))
}

/// Stays on either extreme that are come to amid a motion, and the rows there if it is one of the `limits` of the sensor.
pub(crate) fn at_extremes(run: &Run, limits: &[f64]) -> Vec<(Oddity, Vec<Range<usize>>)> {
    let (low, high) = extremes(&run.position);
    let found = [low, high].map(|value| {
        let is_limit = limits.contains(&value);
        let stay = if is_limit {
            longest_at(&run.position, value)
        } else {
            held_at(run, value)
        }?;
        let (file, from_s) = (run.file.clone(), run.time[stay.start]);
        let stay_s = run.time[stay.end - 1] - from_s;
        Some(if is_limit {
            let saturated = Oddity::Saturated {
                file,
                value,
                from_s,
                stay_s,
            };
            (saturated, at(&run.position, value).collect())
        } else {
            let held = Oddity::Held {
                file,
                value,
                from_s,
                stay_s,
            };
            (held, Vec::new())
        })
    });
    found.into_iter().flatten().collect()
}

/// The longest stay on an extreme, if it is long while the input changes and is come to amid a motion.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
fn held_at(run: &Run, value: f64) -> Option<Range<usize>> {
    let x = &run.position;
    let stay = longest_at(x, value)?;
    let [all, meanwhile] = [&run.input[..], &run.input[stay.clone()]].map(|input| {
        let (least, most) = extremes(input);
        most - least
    });
    let entry = (x.get(stay.start.checked_sub(2)?)? - x.get(stay.start - 1)?).abs();
    let is_held = stay.len() as f64 >= STAY * run.len() as f64
        && meanwhile >= STAY_INPUT * all
        && meanwhile > 0.0
        && entry >= STAY_ENTRY * typical_step(x, 1);
    is_held.then_some(stay)
}

/// The stretches of one value.
fn at(column: &[f64], value: f64) -> impl Iterator<Item = Range<usize>> {
    stays(column).filter(move |stay| column[stay.start] == value)
}

/// The longest of them.
fn longest_at(column: &[f64], value: f64) -> Option<Range<usize>> {
    at(column, value).max_by_key(ExactSizeIterator::len)
}

/// True if the motion `beside` a stay, so many rows from it, is at speed from the first, as it is not where a stop pushes it or a
/// rest is eased into; what is `seen` of it has gone that far.
fn is_at_speed<'a>(
    x: &[f64],
    stay: &Range<usize>,
    seen: f64,
    beside: impl Fn(usize) -> Option<&'a f64>,
) -> bool {
    let gone = |rows: usize| Some((beside(rows)? - x[stay.start]).abs());
    let mut rows = BESIDE..=stay.len().min(MOST_BESIDE);
    let Some(rows) = rows.find(|&rows| gone(rows).is_some_and(|gone| gone >= seen)) else {
        return false;
    };
    let [Some(half), Some(whole)] = [rows / 2, rows].map(gone) else {
        return false;
    };
    half >= AT_SPEED * whole && whole >= STAY_ENTRY * typical_step(x, rows)
}

/// The rows of each stretch of one value.
fn stays(column: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    column.chunk_by(|a, b| a == b).map(move |stay| {
        end += stay.len();
        end - stay.len()..end
    })
}

/// Median step over some rows where there is one.
fn typical_step(column: &[f64], rows: usize) -> f64 {
    let steps = column
        .windows(rows + 1)
        .map(|some| (some[rows] - some[0]).abs());
    median(steps.filter(|step| *step > 0.0).collect())
}

/// Stretches amid a motion that end in a jump to where it has gone, and their rows but the first, which was read.
#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
pub(crate) fn frozen(run: &Run) -> Option<(Oddity, Vec<Range<usize>>)> {
    let x = &run.position;
    let long = stays(x).filter(|stay| stay.len() >= BESIDE);
    let long: Vec<Range<usize>> = long.collect();
    if long.is_empty() {
        return None;
    }
    let usual = usual(x);
    let seen = MOVES * smallest_step(x).max(noise(x));
    let least_gone = seen.min(STAY_ENTRY * typical_step(x, BESIDE));
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
    let steps = changes.iter().map(|&row| (x[row] - x[row - 1]).abs());
    if next_row > NEXT_ROW * changes.len() as f64
        || median(steps.collect()) < BEYOND_COUNTS * smallest_step(x)
    {
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
