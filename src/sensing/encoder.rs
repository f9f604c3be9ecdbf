//! Incremental encoder on the motor, read through a 32-bit counter that wraps.

use core::f32::consts::TAU;

/// Angle of the paddle from the encoder's counter.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    rad_per_count: f32,
    origin_count: u32,
    origin_rad: f32,
}

impl Encoder {
    /// An encoder whose origin is where its counter is 0.
    ///
    /// `counts_per_turn` is per turn of the motor, `ratio` the motor's turns per turn of the paddle.
    pub fn new(counts_per_turn: f32, ratio: f32) -> Self {
        Self {
            rad_per_count: rad_per_count(counts_per_turn, ratio),
            origin_count: 0,
            origin_rad: 0.0,
        }
    }

    /// Takes over a resolution; the origin stays.
    pub fn retune(&mut self, rad_per_count: f32) {
        self.rad_per_count = rad_per_count;
    }

    /// Declares that the paddle stands at `angle_rad` where the counter reads `count`.
    pub fn zero(&mut self, count: u32, angle_rad: f32) {
        self.origin_count = count;
        self.origin_rad = angle_rad;
    }

    /// Angle of the paddle, rad. Right across a wrap of the counter, up to 2^31 counts from the origin.
    #[inline]
    pub fn position_rad(&self, count: u32) -> f32 {
        let from_origin = count.wrapping_sub(self.origin_count) as i32;
        self.origin_rad + from_origin as f32 * self.rad_per_count
    }
}

/// Paddle angle in one count, rad.
pub fn rad_per_count(counts_per_turn: f32, ratio: f32) -> f32 {
    TAU / (counts_per_turn * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DEG_PER_RAD;

    #[test]
    fn a_count_is_twelve_thousandths_of_a_degree() {
        let encoder = Encoder::new(2000.0, 15.0);
        assert!((encoder.position_rad(1) * DEG_PER_RAD - 0.012).abs() < 1e-7);
        assert!((encoder.position_rad(u32::MAX) * DEG_PER_RAD + 0.012).abs() < 1e-7);
    }

    #[test]
    fn the_counter_may_wrap_on_the_way() {
        let mut encoder = Encoder::new(2000.0, 15.0);
        encoder.zero(u32::MAX - 10, 0.1);
        let before = encoder.position_rad(u32::MAX);
        let after = encoder.position_rad(0);
        assert!((after - before - rad_per_count(2000.0, 15.0)).abs() < 1e-7);
        assert_eq!(encoder.position_rad(u32::MAX - 10), 0.1);
    }
}
