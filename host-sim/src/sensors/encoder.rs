//! Incremental encoder and its 32-bit counter.

use haptic_paddle::sensing::encoder::rad_per_count;
use haptic_paddle::settings::MechanismSettings;

/// Converts the position of the paddle to counts. The counter wraps.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    counts_per_rad: f64,
    origin_rad: f64,
    origin_count: u32,
}

impl Encoder {
    /// An encoder that reads `count` within half a count of `position_rad`.
    pub fn new(mechanism: &MechanismSettings, position_rad: f64, count: u32) -> Self {
        let rad_per_count = rad_per_count(mechanism.counts_per_turn, mechanism.ratio);
        Self {
            counts_per_rad: 1.0 / f64::from(rad_per_count),
            origin_rad: position_rad,
            origin_count: count,
        }
    }

    /// The count at `position_rad`.
    #[inline]
    pub fn count(&self, position_rad: f64) -> u32 {
        // Rounds half up by a cast. `round` is a slow library call on some targets.
        let counts = (position_rad - self.origin_rad) * self.counts_per_rad + 0.5;
        let floor = counts as i64 - i64::from(counts < (counts as i64) as f64);
        self.origin_count.wrapping_add(floor as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_start_at_the_given_count_and_wrap() {
        let encoder = Encoder::new(&MechanismSettings::default(), 0.1, u32::MAX);
        let quantum = std::f64::consts::TAU / 30_000.0;
        for (quanta, count) in [
            (0.0, u32::MAX),
            (0.49, u32::MAX),
            (-0.49, u32::MAX),
            (0.51, 0),
            (-0.51, u32::MAX - 1),
            (100.0, 99),
            (-100.0, u32::MAX - 100),
        ] {
            assert_eq!(encoder.count(0.1 + quanta * quantum), count, "{quanta}");
        }
    }
}
