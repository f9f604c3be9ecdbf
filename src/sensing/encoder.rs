//! Incremental encoder on the motor, read through a 32-bit counter that wraps.

use core::f32::consts::TAU;

/// Converts the count of the encoder to the angle of the paddle.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    rad_per_count: f32,
    origin_count: u32,
    origin_rad: f32,
}

impl Encoder {
    /// An encoder whose zero is at count 0.
    ///
    /// `counts_per_turn` is per turn of the motor. `ratio` is the number of motor turns per paddle turn.
    pub fn new(counts_per_turn: f32, ratio: f32) -> Self {
        Self {
            rad_per_count: rad_per_count(counts_per_turn, ratio),
            origin_count: 0,
            origin_rad: 0.0,
        }
    }

    /// Changes the resolution. The zero is kept.
    pub fn retune(&mut self, rad_per_count: f32) {
        self.rad_per_count = rad_per_count;
    }

    /// Sets the zero: the paddle stands at `angle_rad` at the count `count`.
    pub fn zero(&mut self, count: u32, angle_rad: f32) {
        self.origin_count = count;
        self.origin_rad = angle_rad;
    }

    /// Angle of the paddle, rad. It is correct across a wrap of the counter, up to 2^31 counts from the zero.
    #[inline]
    pub fn position_rad(&self, count: u32) -> f32 {
        let from_origin = count.wrapping_sub(self.origin_count) as i32;
        self.origin_rad + from_origin as f32 * self.rad_per_count
    }
}

/// Paddle angle per count, rad.
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
    fn the_angle_is_continuous_when_the_counter_wraps() {
        let mut encoder = Encoder::new(2000.0, 15.0);
        encoder.zero(u32::MAX - 10, 0.1);
        let before = encoder.position_rad(u32::MAX);
        let after = encoder.position_rad(0);
        assert!((after - before - rad_per_count(2000.0, 15.0)).abs() < 1e-7);
        assert_eq!(encoder.position_rad(u32::MAX - 10), 0.1);
    }
}
