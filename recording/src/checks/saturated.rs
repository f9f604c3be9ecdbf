//! Saturated readings: the position stays at the end of the sensor's range, or a stop may hold the device.

use super::constant_segments::{BESIDE, ENTRY, constant_segments, typical_step};
use crate::statistics::{extremes, noise, smallest_step};
use crate::{Oddity, Run};
use std::ops::Range;

/// Least share of the samples in a constant segment that is reported.
const STAY: f64 = 0.02;
/// Least span of the input during that segment, over its whole span.
const STAY_INPUT: f64 = 0.25;
/// Motion that is large enough for a measurement, in multiples of the smallest step or of the noise.
const SEEN: f64 = 10.0;
const MOST_BESIDE: usize = 4 * BESIDE;
/// Least share of that motion in the first half of its time, for a motion that has full speed at once. Constant speed gives
/// a half. A start from rest with constant acceleration gives a quarter.
const AT_SPEED: f64 = 0.4;

/// Extremes at which the sensor of a run saturates: the motion enters and leaves them at full speed.
pub(crate) fn limits(run: &Run) -> impl Iterator<Item = f64> {
    let x = &run.position;
    let (low, high) = extremes(x);
    let extremes = [low, high].into_iter();
    extremes.filter(|&value| is_often(x, value) && is_passed(x, value))
}

/// True if many rows have this value.
#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
fn is_often(x: &[f64], value: f64) -> bool {
    let rows: usize = at(x, value).map(|stay| stay.len()).sum();
    rows as f64 >= STAY * x.len() as f64
}

/// True if a motion enters and leaves a constant segment of this value at full speed.
fn is_passed(x: &[f64], value: f64) -> bool {
    let seen = SEEN * smallest_step(x).max(noise(x));
    at(x, value).any(|stay| {
        let before = |rows: usize| x.get(stay.start.checked_sub(rows)?);
        let after = |rows: usize| x.get(stay.end - 1 + rows);
        is_at_speed(x, &stay, seen, before) && is_at_speed(x, &stay, seen, after)
    })
}

/// Finds constant segments at either extreme. Their rows are returned if the extreme is one of the `limits` of the sensor.
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

/// The longest constant segment at an extreme, if it is long, the input changes during it, and a motion enters it abruptly.
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
        && entry >= ENTRY * typical_step(x, 1);
    is_held.then_some(stay)
}

/// The constant segments of this value.
fn at(column: &[f64], value: f64) -> impl Iterator<Item = Range<usize>> {
    constant_segments(column).filter(move |stay| column[stay.start] == value)
}

/// The longest constant segment of this value.
fn longest_at(column: &[f64], value: f64) -> Option<Range<usize>> {
    at(column, value).max_by_key(ExactSizeIterator::len)
}

/// True if the motion next to a constant segment has full speed at once. A motion that starts from rest, or that comes to rest
/// gradually, does not. `seen` is the motion that is large enough for this test. `beside` gives the position by the number of
/// rows from the segment.
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
    half >= AT_SPEED * whole && whole >= ENTRY * typical_step(x, rows)
}
