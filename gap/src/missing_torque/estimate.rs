//! The missing torque of a recording: noise by likelihood, motion by smoothing, friction along the motion, and again.

use super::path::Path;
use super::samples::Samples;
use super::smoother::{Noise, Smoothed, Steps};
use core::ops::Range;
use host_sim::device::Device;
use rayon::prelude::*;

/// Corners of the smoother that are tried, rad per period: at most a third of what the rows could show.
const HIGHEST_CORNER: f64 = 1.0;
/// And down to this part of a turn a horizon.
const LEAST_TURNS: f64 = 0.5;
const CORNERS: usize = 9;
/// Jitter of the clock, in periods.
const JITTERS: [f64; 6] = [0.0, 0.02, 0.06, 0.15, 0.4, 1.0];
/// Rows that suffice for the noise, in so many stretches.
const ROWS: usize = 4000;
const STRETCHES: usize = 4;
/// Speed below which the direction of sliding is not known, in its standard deviations.
pub(super) const KNOWN_DIRECTION: f64 = 2.0;

/// The missing torque along the motion of a recording.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    pub noise: Noise,
    pub smoothed: Smoothed,
    /// Rows in which the direction of sliding is known.
    pub sliding: Vec<bool>,
}

/// Smooths a recording with a device; `drive` is the torque of its input over each step.
pub(super) fn estimate(
    samples: &Samples,
    device: &Device,
    drive: &[f64],
    horizon_s: f64,
) -> Estimate {
    let steps = Steps::of(samples, &device.mechanics);
    let within = some_rows(samples);
    // Friction and what goes with the position stay in d at first: nothing is known of the motion yet.
    let mut sliding = vec![true; samples.len()];
    let still = vec![0.0; samples.len()];
    let corners = corners(samples, horizon_s);
    let noise = likeliest(&steps, &within, drive, &still, &sliding, &corners, &[0.0]);
    let mut smoothed = steps.smoother(noise, &still, &sliding).smooth(drive);
    let mut noise = noise;
    for again in 0..2 {
        sliding = slides(&smoothed);
        let path = Path::along(samples, device, drive, &smoothed, &sliding);
        let force = path.force(device, drive);
        if again == 0 {
            let velocity = &smoothed.velocity;
            noise = likeliest(
                &steps, &within, &force, velocity, &sliding, &corners, &JITTERS,
            );
        }
        let smoother = steps.smoother(noise, &smoothed.velocity, &sliding);
        smoothed = smoother.smooth(&force);
    }
    sliding = slides(&smoothed);
    Estimate {
        noise,
        smoothed,
        sliding,
    }
}

fn slides(smoothed: &Smoothed) -> Vec<bool> {
    let pairs = smoothed.velocity.iter().zip(&smoothed.velocity_std);
    pairs
        .map(|(v, std)| v.abs() > KNOWN_DIRECTION * std)
        .collect()
}

/// By equal ratios.
fn corners(samples: &Samples, horizon_s: f64) -> Vec<f64> {
    let lowest = LEAST_TURNS * core::f64::consts::TAU * samples.period_s / horizon_s;
    let lowest = lowest.min(0.5 * HIGHEST_CORNER);
    let ratio = (HIGHEST_CORNER / lowest).powf(1.0 / (CORNERS - 1) as f64);
    (0..CORNERS)
        .map(|k| lowest * ratio.powi(k as i32))
        .collect()
}

/// The likeliest of the corners and jitters, the corner refined between those that were tried.
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

/// Some stretches of rows that stand for all.
fn some_rows(samples: &Samples) -> Vec<Range<usize>> {
    if samples.len() <= ROWS {
        return samples.stretches.iter().map(|s| s.rows.clone()).collect();
    }
    let each = ROWS / STRETCHES;
    let apart = samples.len() / STRETCHES;
    let pieces = (0..STRETCHES).filter_map(|k| {
        let from = k * apart + (apart - each) / 2;
        let stretch = samples.stretches.iter().find(|s| s.rows.contains(&from))?;
        Some(from..(from + each).min(stretch.rows.end))
    });
    pieces.filter(|rows| !rows.is_empty()).collect()
}
