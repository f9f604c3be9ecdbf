//! Torque ripple over position: a search over wave numbers before any fit.

use super::Evidence;
use super::regression::moments;
use super::start::{linear, log, term};
use super::waves;
use crate::fit::hypothesis::Term;
use core::f64::consts::TAU;
use host_sim::effects::Kind;

/// Wave numbers from which a fit starts.
const PEAKS: usize = 3;

/// Waves that were travelled at least for a ripple to be seen to repeat.
const LEAST_WAVES: f64 = 1.0;

/// Waves of a ripple between the lowest and the highest of some positions, if they are too few to see it repeat.
pub(crate) fn waves_short(wave_number: f64, [low, high]: [f64; 2]) -> Option<f64> {
    let travelled = wave_number * (high - low) / TAU;
    (travelled < LEAST_WAVES).then_some(travelled)
}

/// The strongest wave numbers in the missing torque, by the share of its variance that a sine and a
/// cosine over position explain.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let known = moments(e).map(|m| (m.position, m.velocity > 0.0, m.missing_nm));
    let peaks = waves::strongest(known.collect(), s).into_iter().take(PEAKS);
    peaks
        .map(|(n, [a, b])| {
            let amplitude = a.hypot(b).max(1e-3 * s.torque);
            // A missing torque is what the motion needed: that of the ripple itself.
            let phase = b.atan2(a);
            let free = vec![
                log(0, amplitude),
                linear(1, n, 0.2 * TAU / s.span()),
                linear(2, phase, 0.5),
                linear(3, 0.0, 0.3 * amplitude),
                linear(4, 0.0, 0.3 * amplitude),
            ];
            term(kind, free, &[])
        })
        .collect()
}
