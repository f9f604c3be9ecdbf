//! Estimates the missing torque of a recording. The noise is found by maximum likelihood and the motion by smoothing. The friction torque
//! then follows from the direction of the motion, and the estimate is repeated.

use super::path::Path;
use super::samples::Samples;
use super::smoother::{Noise, Smoothed, Steps};
use core::ops::Range;
use host_sim::device::Device;
use rayon::prelude::*;

/// Highest corner frequency of the smoother, rad per sample period.
const HIGHEST_CORNER: f64 = 1.0;
/// Lowest corner frequency of the smoother, in periods per horizon.
const LEAST_TURNS: f64 = 0.5;
const CORNERS: usize = 9;
/// Standard deviations of the clock jitter that are tried, in sample periods.
const JITTERS: [f64; 6] = [0.0, 0.02, 0.06, 0.15, 0.4, 1.0];
/// Number of rows that suffices for the noise, and the number of parts in which they are taken.
const ROWS: usize = 4000;
const STRETCHES: usize = 4;
/// Speed, in its standard deviations, below which the direction of sliding is unknown.
pub(super) const KNOWN_DIRECTION: f64 = 2.0;

/// The estimated motion and missing torque of a recording.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    pub noise: Noise,
    pub smoothed: Smoothed,
    /// True for the rows in which the direction of sliding is known.
    pub sliding: Vec<bool>,
}

/// Estimates the missing torque of a device. `drive` is the drive torque over each step, N m.
pub(super) fn estimate(
    samples: &Samples,
    device: &Device,
    drive: &[f64],
    horizon_s: f64,
) -> Estimate {
    let steps = Steps::of(samples, &device.mechanics);
    let within = some_rows(samples);
    // At first the missing torque d includes friction and position-dependent torques, because the motion is unknown.
    let mut sliding = vec![true; samples.len()];
    let at_rest = vec![0.0; samples.len()];
    let corners = corners(samples, horizon_s);
    let noise = likeliest(&steps, &within, drive, &at_rest, &sliding, &corners, &[0.0]);
    let mut smoothed = steps.smoother(noise, &at_rest, &sliding).smooth(drive);
    let mut noise = noise;
    for round in 0..2 {
        sliding = is_sliding(&smoothed);
        let path = Path::along(samples, device, drive, &smoothed, &sliding);
        let force = path.force(device, drive);
        if round == 0 {
            let velocity = &smoothed.velocity;
            noise = likeliest(
                &steps, &within, &force, velocity, &sliding, &corners, &JITTERS,
            );
        }
        let smoother = steps.smoother(noise, &smoothed.velocity, &sliding);
        smoothed = smoother.smooth(&force);
    }
    sliding = is_sliding(&smoothed);
    Estimate {
        noise,
        smoothed,
        sliding,
    }
}

fn is_sliding(smoothed: &Smoothed) -> Vec<bool> {
    let pairs = smoothed.velocity.iter().zip(&smoothed.velocity_std);
    pairs
        .map(|(v, std)| v.abs() > KNOWN_DIRECTION * std)
        .collect()
}

/// Corner frequencies in geometric progression, rad per sample period.
fn corners(samples: &Samples, horizon_s: f64) -> Vec<f64> {
    let lowest = LEAST_TURNS * core::f64::consts::TAU * samples.period_s / horizon_s;
    let lowest = lowest.min(0.5 * HIGHEST_CORNER);
    let ratio = (HIGHEST_CORNER / lowest).powf(1.0 / (CORNERS - 1) as f64);
    (0..CORNERS)
        .map(|k| lowest * ratio.powi(k as i32))
        .collect()
}

/// The noise of maximum likelihood among all corners and jitters. The corner is then refined between its neighbours.
fn likeliest(
    steps: &Steps<'_>,
    within: &[Range<usize>],
    force: &[f64],
    velocity: &[f64],
    sliding: &[bool],
    corners: &[f64],
    jitters: &[f64],
) -> Noise {
    let tried = |noise: Noise| {
        let (likelihood, scale) = steps.likelihood(within, force, velocity, sliding, noise);
        (likelihood, Noise { scale, ..noise })
    };
    let all: Vec<Noise> = jitters
        .iter()
        .flat_map(|&jitter| {
            corners.iter().map(move |&corner| Noise {
                corner,
                jitter,
                scale: 1.0,
            })
        })
        .collect();
    let tries: Vec<(f64, Noise)> = all.into_par_iter().map(tried).collect();
    let better = |a: (f64, Noise), b: (f64, Noise)| if b.0 > a.0 { b } else { a };
    let first = tries[0];
    let best = tries.into_iter().fold(first, better);
    let half = (corners[1] / corners[0]).sqrt();
    let refined = [1.0 / half, half].map(|by| {
        let corner = (best.1.corner * by).min(HIGHEST_CORNER);
        tried(Noise { corner, ..best.1 })
    });
    refined.into_iter().fold(best, better).1
}

/// Evenly spread parts of the rows that represent all of them.
fn some_rows(samples: &Samples) -> Vec<Range<usize>> {
    if samples.len() <= ROWS {
        return samples.stretches.iter().map(|s| s.rows.clone()).collect();
    }
    let each = ROWS / STRETCHES;
    let spacing = samples.len() / STRETCHES;
    let pieces = (0..STRETCHES).filter_map(|k| {
        let from = k * spacing + (spacing - each) / 2;
        let stretch = samples.stretches.iter().find(|s| s.rows.contains(&from))?;
        Some(from..(from + each).min(stretch.rows.end))
    });
    pieces.filter(|rows| !rows.is_empty()).collect()
}
