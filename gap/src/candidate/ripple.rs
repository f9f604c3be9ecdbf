//! Ripple of the reading over position: a search over wave numbers before any fit.

use super::Evidence;
use super::regression::{Moment, moments};
use super::start::{linear, term};
use super::waves::Waves;
use crate::fit::hypothesis::{Coordinate, Term};
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use nalgebra::{Matrix2, Vector2};

/// Periods over the span of the motion are tried at this spacing, up to so many.
const TURNS_APART: f64 = 0.25;
const MOST_TURNS: f64 = 150.0;
/// Moments that are looked at for that, wave numbers from which a fit starts, and how much of the slope a ripple is.
const MOST_MOMENTS: usize = 1500;
const PEAKS: usize = 2;
const MOST_SLOPE: f64 = 0.5;

/// A ripple from the amplitudes of its sine and its cosine. Where a torque depends on the position it shows what a sensor
/// reads at zero.
pub(super) fn start(
    kind: &'static Kind,
    e: &Evidence<'_>,
    [sine, cosine]: [f64; 2],
    scale: f64,
    waves: Coordinate,
) -> Term {
    let m = &e.device.mechanics;
    let mut free = vec![linear(2, sine, scale), linear(3, cosine, scale), waves];
    if m.is_pulled() {
        free.push(linear(5, 0.0, scale));
    }
    term(kind, free, &[(0, 0.0), (1, 0.0)])
}

/// The ripples that explain most of the missing torque: where the reading is x + g(x), its acceleration is g'(x) ẍ + g''(x) ẋ²
/// more than that of the position.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let moments: Vec<Moment> = moments(e).collect();
    let stride = (moments.len() / MOST_MOMENTS).max(1);
    let some: Vec<&Moment> = moments.iter().step_by(stride).collect();
    let positions: Vec<f64> = some.iter().map(|m| m.position).collect();
    let turn = TAU / s.span();
    let highest = s.finest_wave_number().min(MOST_TURNS * turn);
    let apart = TURNS_APART * turn;
    let count = (highest / apart) as usize;
    let mut waves = Waves::of(&positions, apart, apart);
    let tried: Vec<(f64, [f64; 3])> = (1..=count)
        .map(|k| {
            let n = apart * k as f64;
            let waved = some.iter().copied().zip(waves.now());
            let (explained, [sine, cosine]) = explained(waved, n, e.device.mechanics.inertia);
            waves.go_on();
            (explained, [n, sine, cosine])
        })
        .collect();
    let mut peaks: Vec<(f64, [f64; 3])> = tried
        .windows(3)
        .filter(|near| near[1].0 > near[0].0.max(near[2].0))
        .map(|near| near[1])
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let peaks = peaks.into_iter().take(PEAKS);
    peaks
        .map(|(_, [n, sine, cosine])| {
            let amplitude = sine.hypot(cosine);
            let most = MOST_SLOPE / n;
            let part = (most / amplitude).min(1.0);
            let scale = (part * amplitude).max(0.1 * most);
            let waves = linear(4, n, apart);
            start(kind, e, [part * sine, part * cosine], scale, waves)
        })
        .collect()
}

/// How much of the missing torque, squared, a sine and a cosine in the reading explain, and their amplitudes.
fn explained<'a>(
    moments: impl Iterator<Item = (&'a Moment, &'a [f64; 2])>,
    wave_number: f64,
    inertia: f64,
) -> (f64, [f64; 2]) {
    let mut normal = Matrix2::zeros();
    let mut right = Vector2::zeros();
    for (m, [sin, cos]) in moments {
        let bend = wave_number * m.acceleration;
        let turn = (wave_number * m.velocity).powi(2);
        let row = inertia * Vector2::new(bend * cos - turn * sin, -bend * sin - turn * cos);
        normal += row * row.transpose();
        right += row * m.missing_nm;
    }
    let Some(solution) = normal.cholesky().map(|c| c.solve(&right)) else {
        return (0.0, [0.0; 2]);
    };
    (solution.dot(&right), [solution[0], solution[1]])
}
