//! How much of a missing torque is a function of one axis, by cross-validation over blocks of time.

use super::axis::Axis;
use super::path::{Path, sign};
use super::regression::{Normal, Rows};
use super::ripple::Waves;
use super::shortlist::respond;
use super::smoother::Smoother;
use rayon::prelude::*;
use serde::Serialize;

/// Number of knots of a table over an axis.
const KNOTS: usize = 7;
/// Prior standard deviation of a table value, in rms of the missing torque.
const LARGEST: f64 = 1.0;
/// Share by which a more general axis must explain more to be ranked first.
const LEAST_ADVANTAGE: f64 = 0.02;
/// Number of waves that a function of the position may contain.
const WAVES: usize = 2;
/// Delays of the input on the memory axis, over the time of one radian of the motion.
const DELAYS: [f64; 2] = [0.1, 0.3];

/// The axes in the order of preference if they explain nearly the same share: the simplest first.
const AXES: [Axis; 9] = [
    Axis::Constant,
    Axis::Velocity,
    Axis::Position,
    Axis::Input,
    Axis::Acceleration,
    Axis::Load,
    Axis::DirectionAndPosition,
    Axis::Memory,
    Axis::Time,
];
/// Axes of the best additive law.
const ADDITIVE: [Axis; 5] = [
    Axis::Velocity,
    Axis::Position,
    Axis::Input,
    Axis::Load,
    Axis::DirectionAndPosition,
];

/// The share of the squared missing torque that a function of one axis explains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Axis of the function.
    pub axis: Axis,
    /// Share on held-out blocks of time. It is negative if the function is worse than none.
    pub share: f64,
}

/// Shares of all axes, largest first, and the share of the best additive law.
pub(super) fn shares(
    path: &Path<'_>,
    smoother: &Smoother<'_>,
    rows: &Rows,
    target: &[f64],
    rms: f64,
    waves: &Waves,
) -> (Vec<Share>, f64) {
    let tables = AXES.par_iter().map(|&axis| {
        let torque = table(axis, path, waves, LARGEST * rms);
        (axis, respond(smoother, rows, &torque, &[]))
    });
    let mut tables: Vec<(Axis, Vec<Vec<f64>>)> = tables.collect();
    let velocity = tables.iter().find(|(axis, _)| *axis == Axis::Velocity);
    let halves = velocity.map(|(_, columns)| {
        let (odd, even) = columns.split_at(KNOTS);
        [
            (Axis::VelocityOdd, odd.to_vec()),
            (Axis::VelocityEven, even.to_vec()),
        ]
    });
    let explained = |columns: &[&[f64]]| {
        let normal = Normal::of(rows, columns, columns.len(), target);
        let all: Vec<usize> = (0..columns.len()).collect();
        1.0 - normal.held_out(&all) / normal.target_squares().max(f64::MIN_POSITIVE)
    };
    fn of(columns: &[Vec<f64>]) -> Vec<&[f64]> {
        columns.iter().map(Vec::as_slice).collect()
    }
    let law = tables.iter().filter(|(axis, _)| ADDITIVE.contains(axis));
    let law: Vec<&[f64]> = law.flat_map(|(_, columns)| of(columns)).collect();
    let additive = explained(&law);
    tables.extend(halves.into_iter().flatten());
    let all = tables.par_iter().map(|(axis, columns)| Share {
        axis: *axis,
        share: explained(&of(columns)),
    });
    let all: Vec<Share> = all.collect();
    let most = all
        .iter()
        .fold(additive, |most, share| share.share.max(most));
    (ranked(all), most)
}

/// Ranks the shares, largest first. Among nearly equal shares the simplest axis comes first.
fn ranked(mut remaining: Vec<Share>) -> Vec<Share> {
    let mut ranked = Vec::with_capacity(remaining.len());
    while !remaining.is_empty() {
        let most = remaining
            .iter()
            .fold(f64::NEG_INFINITY, |most, s| s.share.max(most));
        let first = remaining
            .iter()
            .position(|s| s.share >= most - LEAST_ADVANTAGE);
        ranked.push(remaining.remove(first.unwrap_or(0)));
    }
    ranked
}

/// Columns of a table over an axis, each with a largest value of `size`.
fn table(axis: Axis, path: &Path<'_>, waves: &Waves, size: f64) -> Vec<Vec<f64>> {
    let n = path.position.len();
    let opposing: Vec<f64> = path.direction.iter().map(|d| -d).collect();
    let ones = vec![1.0; n];
    let magnitudes = |values: &[f64]| values.iter().map(|v| v.abs()).collect::<Vec<_>>();
    let hats = |values: &[f64], by: &[f64]| hats(path, values, by, size);
    match axis {
        Axis::Constant => vec![vec![size; n]],
        Axis::Velocity => {
            let speed = magnitudes(&path.velocity);
            [hats(&speed, &opposing), hats(&speed, &ones)].concat()
        }
        Axis::Position => {
            let mut columns = hats(&path.position, &ones);
            // A ripple is finer than the spacing of the knots.
            for n in waves.strongest.iter().take(WAVES) {
                let wave = |f: fn(f64) -> f64| -> Vec<f64> {
                    path.position.iter().map(|x| size * f(n * x)).collect()
                };
                columns.extend([wave(f64::sin), wave(f64::cos)]);
            }
            columns
        }
        Axis::Input => hats(&path.drive, &ones),
        Axis::Acceleration => hats(&path.torque(path.device), &ones),
        Axis::Load => {
            // Friction may differ between a driving motor and a driving load.
            let size = magnitudes(&path.drive);
            let only = |motor: bool| -> Vec<f64> {
                let drives = path.drive.iter().zip(&opposing).map(|(t, a)| t * a < 0.0);
                let pairs = drives.zip(&opposing);
                pairs
                    .map(|(drives, a)| if drives == motor { *a } else { 0.0 })
                    .collect()
            };
            [hats(&size, &only(true)), hats(&size, &only(false))].concat()
        }
        Axis::DirectionAndPosition => hats(&path.position, &opposing),
        Axis::Memory => memory(path, &opposing, size),
        Axis::Time => hats(&path.samples.session_s, &ones),
        Axis::VelocityOdd | Axis::VelocityEven | Axis::Wave => Vec::new(),
    }
}

/// Columns of the memory axis: distance since the last reversal, and delayed input.
fn memory(path: &Path<'_>, opposing: &[f64], size: f64) -> Vec<Vec<f64>> {
    let (mut distance, mut last) = (0.0, 0.0);
    let distances = (0..opposing.len()).map(|i| {
        let now = sign(path.direction[i]);
        if now != last || path.samples.step_s[i] == 0.0 {
            (distance, last) = (0.0, now);
        }
        distance += (path.velocity[i] * path.samples.step_s[i]).abs();
        distance
    });
    let distances: Vec<f64> = distances.collect();
    let mut columns = hats(path, &distances, opposing, size);
    for part in DELAYS {
        let mut delayed = path.device.clone();
        delayed.drive.delay_s += part / path.scale.rate();
        let change = path.added_torque(&delayed).into_iter();
        columns.push(change.map(|t| t * size / path.scale.torque).collect());
    }
    columns
}

/// Hat functions over the values of an axis, between its 0.5 % and 99.5 % quantiles, each multiplied by a factor per step.
fn hats(path: &Path<'_>, values: &[f64], by: &[f64], size: f64) -> Vec<Vec<f64>> {
    const EDGE_SHARE: f64 = 0.005;
    let moving = values
        .iter()
        .zip(&path.sliding)
        .filter(|(_, is_sliding)| **is_sliding);
    let mut sorted: Vec<f64> = moving.map(|(value, _)| *value).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((sorted.len().saturating_sub(1) as f64 * share) as usize);
    let (Some(&low), Some(&high)) = (at(EDGE_SHARE), at(1.0 - EDGE_SHARE)) else {
        return vec![vec![0.0; values.len()]; KNOTS];
    };
    let mut columns = vec![vec![0.0; values.len()]; KNOTS];
    let per_knot = (KNOTS - 1) as f64 / (high - low).max(f64::MIN_POSITIVE);
    for (i, value) in values.iter().enumerate() {
        let at = ((value - low) * per_knot).clamp(0.0, (KNOTS - 1) as f64);
        let knot = (at as usize).min(KNOTS - 2);
        let part = at - knot as f64;
        columns[knot][i] = size * by[i] * (1.0 - part);
        columns[knot + 1][i] = size * by[i] * part;
    }
    columns
}
