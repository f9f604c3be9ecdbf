//! What `f32` of `core` lacks.

/// `value` limited to `-limit ..= limit`. Unlike [`f32::clamp`] it never panics, and NaN stays NaN so that it is noticed.
#[inline]
pub fn limit(value: f32, limit: f32) -> f32 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}

/// Below this a state that decays is over.
const NEGLIGIBLE: f32 = 1e-20;

/// 0 for a value that decayed to nothing: subnormal numbers are many times slower on most processors.
#[inline]
pub fn flushed(value: f32) -> f32 {
    if value.abs() < NEGLIGIBLE { 0.0 } else { value }
}
