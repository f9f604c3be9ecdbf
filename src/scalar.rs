//! Functions of `f32` that `core` lacks.

/// `value` limited to `-limit ..= limit`. Unlike [`f32::clamp`] it never panics. NaN stays NaN, so that it is detected.
#[inline]
pub fn limit(value: f32, limit: f32) -> f32 {
    let below = if value > limit { limit } else { value };
    if below < -limit { -limit } else { below }
}

/// A decaying state below this counts as zero.
const NEGLIGIBLE: f32 = 1e-20;

/// Returns 0 for a negligible value. Subnormal numbers are many times slower on most processors.
///
/// The addition rounds away small values. The resulting error of values above 1e-12 is not noticeable.
#[inline]
pub fn flushed(value: f32) -> f32 {
    (value + NEGLIGIBLE) - NEGLIGIBLE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negligible_values_are_flushed_to_zero_and_others_are_kept() {
        for decayed in [1e-40, -1e-40, 1e-30, -1e-30] {
            assert_eq!(flushed(decayed), 0.0);
        }
        for value in [1e-12, -1e-12, 0.1, -3e9, f32::INFINITY] {
            assert_eq!(flushed(value), value);
        }
        assert!(flushed(f32::NAN).is_nan());
    }
}
