//! Torque ripple over position: a search over wave numbers before any fit.

use super::Evidence;
use super::regression::moments;
use super::start::{linear, log, term};
use super::waves::Waves;
use crate::fit::hypothesis::Term;
use core::f64::consts::TAU;
use host_sim::effects::Kind;

/// Wave numbers tried.
const GRID: usize = 600;
/// Moments that are looked at for that.
const MOST_MOMENTS: usize = 6000;
/// Wave numbers from which a fit starts.
const PEAKS: usize = 3;

/// The strongest wave numbers in the missing torque, by the share of its variance that a sine and a
/// cosine over position explain.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let known = moments(e).map(|m| (m.position, m.velocity, m.missing_nm));
    let mut samples: Vec<(f64, f64, f64)> = known.collect();
    if samples.len() < GRID / 10 {
        return Vec::new();
    }
    // Slow trends belong to others: the mean in each direction is taken out.
    for forward in [true, false] {
        let mine: Vec<f64> = samples
            .iter()
            .filter(|s| (s.1 > 0.0) == forward)
            .map(|s| s.2)
            .collect();
        let mean = mine.iter().sum::<f64>() / mine.len().max(1) as f64;
        for sample in samples.iter_mut().filter(|s| (s.1 > 0.0) == forward) {
            sample.2 -= mean;
        }
    }
    let lowest = TAU / s.span();
    let highest = s.finest_wave_number();
    if highest <= lowest {
        return Vec::new();
    }
    // Resolution is 2π over the span; on many turns whole numbers a turn are enough.
    let step = ((highest - lowest) / GRID as f64).max(0.25 * lowest);
    let count = ((highest - lowest) / step) as usize + 1;
    let stride = (samples.len() / MOST_MOMENTS).max(1);
    samples = samples.into_iter().step_by(stride).collect();
    let positions: Vec<f64> = samples.iter().map(|s| s.0).collect();
    let mut waves = Waves::of(&positions, lowest, step);
    let grid: Vec<(f64, (f64, f64))> = (0..count)
        .map(|i| {
            let (mut a, mut b) = (0.0, 0.0);
            for ((_, _, m), [sin, cos]) in samples.iter().zip(waves.now()) {
                a += m * sin;
                b += m * cos;
            }
            waves.go_on();
            let mean = 2.0 / samples.len() as f64;
            (lowest + step * i as f64, (mean * a, mean * b))
        })
        .collect();
    let strength = |i: usize| grid[i].1.0.hypot(grid[i].1.1);
    let mut peaks: Vec<usize> = (0..grid.len())
        .filter(|&i| {
            (i == 0 || strength(i) >= strength(i - 1))
                && (i + 1 == grid.len() || strength(i) > strength(i + 1))
        })
        .collect();
    peaks.sort_by(|&i, &j| strength(j).total_cmp(&strength(i)));
    let peaks = peaks.into_iter().take(PEAKS);
    peaks
        .map(|i| {
            let (n, (a, b)) = grid[i];
            let amplitude = a.hypot(b).max(1e-3 * s.torque);
            // A missing torque is what the motion needed: that of the ripple itself.
            let phase = b.atan2(a);
            let free = vec![
                log(0, amplitude),
                linear(1, n, 0.2 * lowest),
                linear(2, phase, 0.5),
                linear(3, 0.0, 0.3 * amplitude),
                linear(4, 0.0, 0.3 * amplitude),
            ];
            term(kind, free, &[])
        })
        .collect()
}
