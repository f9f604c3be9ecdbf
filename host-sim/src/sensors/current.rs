//! Shunt amplifier of the motor current with its converter.

use crate::sensors::Noise;
use haptic_paddle::sensing::current::CurrentSensor;

/// Reads the mean current of a tick.
#[derive(Clone, Copy, Debug)]
pub struct CurrentAmplifier {
    idle_counts: f64,
    counts_per_a: f64,
    /// Noise of the mean over a tick, A rms.
    pub noise_a: f64,
}

/// Assumed noise: one count, the remainder of the amplifier's noise at 120 kHz after averaging.
const NOISE_A: f64 = 0.8e-3;

impl Default for CurrentAmplifier {
    /// The amplifier that matches the core's current sensor. The mean of many conversions is not quantised.
    fn default() -> Self {
        let sensor = CurrentSensor::default();
        let amperes_at_0 = f64::from(sensor.amperes(0.0));
        let amperes_at_2000 = f64::from(sensor.amperes(2000.0));
        let counts_per_a = 2000.0 / (amperes_at_2000 - amperes_at_0);
        Self {
            idle_counts: -amperes_at_0 * counts_per_a,
            counts_per_a,
            noise_a: NOISE_A,
        }
    }
}

impl CurrentAmplifier {
    /// Mean count of the converter over a tick with the mean current `current_a`.
    #[inline]
    pub fn counts(&self, current_a: f64, noise: &mut Noise) -> f32 {
        (self.idle_counts + self.counts_per_a * (current_a + noise.next(self.noise_a))) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_core_reads_the_current_back_with_its_sign() {
        let amplifier = CurrentAmplifier {
            noise_a: 0.0,
            ..CurrentAmplifier::default()
        };
        let sensor = CurrentSensor::default();
        for current_a in [-1.5, -0.01, 0.0, 0.6] {
            let counts = amplifier.counts(current_a, &mut Noise::new(0));
            assert!((f64::from(sensor.amperes(counts)) - current_a).abs() < 1e-5);
        }
    }
}
