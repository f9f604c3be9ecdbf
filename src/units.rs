//! Conversion between degrees, for people, and radians, for calculations.

use core::f32::consts::PI;

/// Radians in a degree.
pub const RAD_PER_DEG: f32 = PI / 180.0;

/// Degrees in a radian.
pub const DEG_PER_RAD: f32 = 180.0 / PI;
