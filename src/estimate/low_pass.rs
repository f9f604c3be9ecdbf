//! First-order low-pass.

use core::f32::consts::TAU;

use crate::scalar::flushed;

/// `y += a (x - y)`, the filter of the lab report (forward Euler discretisation of a first-order lag).
#[derive(Clone, Copy, Debug, Default)]
pub struct LowPass {
    gain: f32,
    output: f32,
}

/// `a = min(1, 2 pi f T)`. A cutoff of 0 gives 1, which is no filtering.
pub fn gain(cutoff_hz: f32, tick_s: f32) -> f32 {
    if cutoff_hz > 0.0 {
        (TAU * cutoff_hz * tick_s).min(1.0)
    } else {
        1.0
    }
}

impl LowPass {
    /// A filter with the gain of [`gain`], at rest at 0.
    pub fn new(gain: f32) -> Self {
        Self { gain, output: 0.0 }
    }

    /// Changes the gain. The output is kept.
    pub fn retune(&mut self, gain: f32) {
        self.gain = gain;
    }

    /// Sets the filter to rest at `value`.
    pub fn reset(&mut self, value: f32) {
        self.output = value;
    }

    /// Filters one sample.
    #[inline]
    pub fn update(&mut self, input: f32) -> f32 {
        self.output = flushed(self.output + self.gain * (input - self.output));
        self.output
    }

    /// The last output.
    #[inline]
    pub fn output(&self) -> f32 {
        self.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_labs_filter_has_a_gain_of_0_22() {
        assert!((gain(100.0, 350e-6) - 0.22).abs() < 1e-3);
        assert_eq!(gain(0.0, 350e-6), 1.0);
        assert_eq!(gain(1e6, 350e-6), 1.0);
    }

    #[test]
    fn a_step_is_approached_geometrically() {
        let mut filter = LowPass::new(0.25);
        for _ in 0..10 {
            filter.update(1.0);
        }
        assert!((1.0 - filter.output() - 0.75_f32.powi(10)).abs() < 1e-6);
    }
}
