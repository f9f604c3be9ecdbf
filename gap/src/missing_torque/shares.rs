//! How much of a missing torque is a function of one axis, on blocks of time that the fit has not seen.

use super::axis::Axis;
use super::path::{Path, sign};
use super::regression::{Normal, Rows};
use super::ripple::Waves;
use super::shortlist::respond;
use super::smoother::Smoother;
use rayon::prelude::*;
use serde::Serialize;

/// Knots of a table over an axis.
const KNOTS: usize = 7;
/// A table's values are within this many rms of the missing torque, as a standard deviation known beforehand.
const LARGEST: f64 = 1.0;
/// Share by which an axis must explain more than one that says less.
const CLEARLY: f64 = 0.02;
/// Waves over the position that a function of it may have beside.
const WAVES: usize = 2;
/// Delays of the input that memory may have, over the time of a radian of the motion.
const DELAYS: [f64; 2] = [0.1, 0.3];

/// The axes in the order in which they are preferred where they explain alike: those that say least first.
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
/// Those of which the best additive law is made.
const ADDITIVE: [Axis; 5] = [
    Axis::Velocity,
    Axis::Position,
    Axis::Input,
    Axis::Load,
    Axis::DirectionAndPosition,
];

/// The share of the missing torque, squared, that a function of one axis explains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// That which the function is of.
    pub axis: Axis,
    /// On blocks of time that the fit has not seen; below 0 where it is worse than nothing.
    pub share: f64,
}

/// Shares of all axes, the most telling first, and of the best additive law.
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

/// The most telling first; of those that explain nearly alike, the one that says least.
fn ranked(mut left: Vec<Share>) -> Vec<Share> {
    let mut ranked = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let most = left
            .iter()
            .fold(f64::NEG_INFINITY, |most, s| s.share.max(most));
        let first = left.iter().position(|s| s.share >= most - CLEARLY);
        ranked.push(left.remove(first.unwrap_or(0)));
    }
    ranked
}

/// Columns of a table over an axis, each up to `size`.
fn table(axis: Axis, path: &Path<'_>, waves: &Waves, size: f64) -> Vec<Vec<f64>> {
    let n = path.position.len();
    let against: Vec<f64> = path.direction.iter().map(|d| -d).collect();
    let alike = vec![1.0; n];
    let magnitudes = |values: &[f64]| values.iter().map(|v| v.abs()).collect::<Vec<_>>();
    let hats = |places: &[f64], by: &[f64]| hats(path, places, by, size);
    match axis {
        Axis::Constant => vec![vec![size; n]],
        Axis::Velocity => {
            let speed = magnitudes(&path.velocity);
            [hats(&speed, &against), hats(&speed, &alike)].concat()
        }
        Axis::Position => {
            let mut columns = hats(&path.position, &alike);
            // A ripple is finer than any knots.
            for n in waves.strongest.iter().take(WAVES) {
                let wave = |f: fn(f64) -> f64| -> Vec<f64> {
                    path.position.iter().map(|x| size * f(n * x)).collect()
                };
                columns.extend([wave(f64::sin), wave(f64::cos)]);
            }
            columns
        }
        Axis::Input => hats(&path.drive, &alike),
        Axis::Acceleration => hats(&path.torque(path.device), &alike),
        Axis::Load => {
            // Friction may be another one where the load drives the motor.
            let size = magnitudes(&path.drive);
            let only = |motor: bool| -> Vec<f64> {
                let drives = path.drive.iter().zip(&against).map(|(t, a)| t * a < 0.0);
                let pairs = drives.zip(&against);
                pairs
                    .map(|(drives, a)| if drives == motor { *a } else { 0.0 })
                    .collect()
            };
            [hats(&size, &only(true)), hats(&size, &only(false))].concat()
        }
        Axis::DirectionAndPosition => hats(&path.position, &against),
        Axis::Memory => memory(path, &against, size),
        Axis::Time => hats(&path.samples.session_s, &alike),
        Axis::VelocityOdd | Axis::VelocityEven | Axis::Wave => Vec::new(),
    }
}

/// Way since the last reversal, and the input some time ago.
fn memory(path: &Path<'_>, against: &[f64], size: f64) -> Vec<Vec<f64>> {
    let (mut way, mut last) = (0.0, 0.0);
    let ways = (0..against.len()).map(|i| {
        let now = sign(path.direction[i]);
        if now != last || path.samples.step_s[i] == 0.0 {
            (way, last) = (0.0, now);
        }
        way += (path.velocity[i] * path.samples.step_s[i]).abs();
        way
    });
    let ways: Vec<f64> = ways.collect();
    let mut columns = hats(path, &ways, against, size);
    for part in DELAYS {
        let mut late = path.device.clone();
        late.drive.delay_s += part / path.scale.rate();
        let change = path.on_top(&late).into_iter();
        columns.push(change.map(|t| t * size / path.scale.torque).collect());
    }
    columns
}

/// Hat functions over the places, from the rarest on either side, times a factor each.
fn hats(path: &Path<'_>, places: &[f64], by: &[f64], size: f64) -> Vec<Vec<f64>> {
    const RAREST: f64 = 0.005;
    let moving = places
        .iter()
        .zip(&path.sliding)
        .filter(|(_, slides)| **slides);
    let mut sorted: Vec<f64> = moving.map(|(place, _)| *place).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((sorted.len().saturating_sub(1) as f64 * share) as usize);
    let (Some(&low), Some(&high)) = (at(RAREST), at(1.0 - RAREST)) else {
        return vec![vec![0.0; places.len()]; KNOTS];
    };
    let mut columns = vec![vec![0.0; places.len()]; KNOTS];
    let per_knot = (KNOTS - 1) as f64 / (high - low).max(f64::MIN_POSITIVE);
    for (i, place) in places.iter().enumerate() {
        let at = ((place - low) * per_knot).clamp(0.0, (KNOTS - 1) as f64);
        let knot = (at as usize).min(KNOTS - 2);
        let part = at - knot as f64;
        columns[knot][i] = size * by[i] * (1.0 - part);
        columns[knot + 1][i] = size * by[i] * part;
    }
    columns
}
