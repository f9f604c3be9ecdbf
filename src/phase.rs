//! Binary angles: one turn is 2^32, so that wrapping integer addition stays exact.

use core::f32::consts::TAU;

const COUNTS_PER_TURN: f32 = 4_294_967_296.0;
const UNITS_PER_FULL_SCALE: f32 = 1.0 / 2_147_483_648.0;

/// An angle as a 32-bit fraction of a turn; it wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phase(pub u32);

impl Phase {
    /// Converts an angle in radians. Whole turns are dropped. The resolution is the 24 bits of `f32`.
    #[inline]
    pub fn from_rad(angle_rad: f32) -> Self {
        let turns = angle_rad * (1.0 / TAU);
        let part = turns - turns as i32 as f32;
        // The factor is half a turn, because a whole turn in either direction does not fit into an `i32`.
        Self(((part * (0.5 * COUNTS_PER_TURN)) as i32 as u32) << 1)
    }

    /// This phase plus `counts` (2^32 per turn).
    #[inline]
    pub fn advanced(self, counts: u32) -> Self {
        Self(self.0.wrapping_add(counts))
    }

    /// Sine with an error of 1e-5.
    #[inline]
    pub fn sin(self) -> f32 {
        idsp::cossin(self.0 as i32).1 as f32 * UNITS_PER_FULL_SCALE
    }

    /// Cosine and sine with an error of 1e-5.
    #[inline]
    pub fn cos_sin(self) -> (f32, f32) {
        let (cos, sin) = idsp::cossin(self.0 as i32);
        (
            cos as f32 * UNITS_PER_FULL_SCALE,
            sin as f32 * UNITS_PER_FULL_SCALE,
        )
    }

    /// Square wave: 1 in the first half of the turn, then -1.
    #[inline]
    pub fn square(self) -> f32 {
        if (self.0 as i32) < 0 { -1.0 } else { 1.0 }
    }

    /// Triangle wave in phase with the sine: 0, 1 at a quarter, -1 at three quarters.
    #[inline]
    pub fn triangle(self) -> f32 {
        let from_trough = self.advanced(1 << 30).0;
        let folded = if (from_trough as i32) < 0 {
            !from_trough
        } else {
            from_trough
        };
        folded as f32 * (2.0 * UNITS_PER_FULL_SCALE) - 1.0
    }
}

/// Phase increment per tick of `tick_s` for `frequency_hz`: a [`Phase`] with 32 more fractional bits.
///
/// It is exact except for the rounding of the product. Frequencies above half the tick rate are lowered to it.
/// Exact but for the rounding of the product; frequencies above half the tick rate are lowered to it.
pub fn increment(frequency_hz: f32, tick_s: f32) -> i64 {
    (crate::scalar::limit(frequency_hz * tick_s, 0.5) * COUNTS_PER_TURN * COUNTS_PER_TURN) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sine_is_right_for_negative_angles_and_beyond_a_turn() {
        for step in -1000..=1000 {
            let angle_rad = 0.01 * step as f32;
            let expected = libm::sinf(angle_rad);
            assert!((Phase::from_rad(angle_rad).sin() - expected).abs() < 2e-5);
        }
    }
}
