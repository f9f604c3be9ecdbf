//! What `f32` of `core` lacks.

/// `value` limited to `-limit ..= limit`. Unlike [`f32::clamp`] it never panics, and NaN stays NaN so that it is noticed.
#[inline]
pub fn limit(value: f32, limit: f32) -> f32 {
    let below = if value > limit { limit } else { value };
    if below < -limit { -limit } else { below }
}

/// A state that decays is over far below this.
const NEGLIGIBLE: f32 = 1e-20;

/// 0 for a value that decayed to nothing: subnormal numbers are many times slower on most processors.
///
/// The sum rounds away what is smaller than its last bit, and a value above 1e-12 is too large to notice.
#[inline]
pub fn flushed(value: f32) -> f32 {
    (value + NEGLIGIBLE) - NEGLIGIBLE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_decayed_is_flushed_and_the_rest_stays() {
        for decayed in [1e-40, -1e-40, 1e-30, -1e-30] {
            assert_eq!(flushed(decayed), 0.0);
        }
        for value in [1e-12, -1e-12, 0.1, -3e9, f32::INFINITY] {
            assert_eq!(flushed(value), value);
        }
        assert!(flushed(f32::NAN).is_nan());
    }
}
