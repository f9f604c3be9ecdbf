//! Integral action that does not wind up.

use crate::scalar::limit;

/// Adds this tick's `step` to the integral, and gives the output: `held`, which is everything else with the integral so
/// far, plus the step, within `-bound ..= bound`.
///
/// While the output is at its bound, the integral only takes what leads back from it.
#[inline]
pub fn integrate(integral: &mut f32, held: f32, step: f32, bound: f32) -> f32 {
    let output = held + step;
    let unlimited = if output.abs() <= bound || output * step < 0.0 {
        *integral += step;
        output
    } else {
        held
    };
    limit(unlimited, bound)
}
