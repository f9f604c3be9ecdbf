//! Integral action with anti-windup.

use crate::scalar::limit;

/// Adds the `step` of this tick to the integral. Returns `held + step`, limited to `-bound ..= bound`. `held` is the sum of
/// all other terms and the previous integral.
///
/// While the output is at its bound, the integral accepts only steps that lead back from it.
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
