//! Angles in degrees for people, in radians for the arithmetic.

use core::f32::consts::PI;

/// Radians in a degree.
pub const RAD_PER_DEG: f32 = PI / 180.0;

/// Degrees in a radian.
pub const DEG_PER_RAD: f32 = 180.0 / PI;

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
