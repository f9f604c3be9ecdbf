//! Hall sensor opposite a magnet on the paddle. It measures absolute angles, but is nonlinear, noisy and different on every
//! paddle.

use super::ADC_VOLTS_PER_COUNT;
use crate::settings::HallSettings;
use crate::units::RAD_PER_DEG;

/// Highest result of the converter.
pub const ADC_FULL_SCALE: u16 = 4095;

// Input stage of the board: Hall volts = (2 V_adc - 2.5) / 1.1 + 2.5.
const HALL_VOLTS_PER_COUNT: f32 = 2.0 * ADC_VOLTS_PER_COUNT / 1.1;
const HALL_VOLTS_AT_COUNT_0: f32 = 2.5 - 2.5 / 1.1;

/// Output voltage of the Hall sensor, V, from the converter's count.
#[inline]
pub fn volts(adc: u16) -> f32 {
    HALL_VOLTS_AT_COUNT_0 + f32::from(adc) * HALL_VOLTS_PER_COUNT
}

/// Calibration curve: a cubic around its centre, in counts.
#[derive(Clone, Copy, Debug)]
pub struct HallCurve {
    centre_counts: f32,
    linear: f32,
    quadratic: f32,
    cubic: f32,
}

impl HallCurve {
    /// The curve of these settings, in radians.
    pub fn new(settings: &HallSettings) -> Self {
        const V: f32 = HALL_VOLTS_PER_COUNT;
        Self {
            centre_counts: (settings.centre_v - HALL_VOLTS_AT_COUNT_0) / V,
            linear: settings.slope_deg_per_v * RAD_PER_DEG * V,
            quadratic: settings.quadratic_deg_per_v2 * RAD_PER_DEG * (V * V),
            cubic: settings.cubic_deg_per_v3 * RAD_PER_DEG * (V * V * V),
        }
    }

    /// Angle of the paddle, rad, from the converter's count.
    #[inline]
    pub fn position_rad(&self, adc: u16) -> f32 {
        let counts = f32::from(adc) - self.centre_counts;
        counts * (self.linear + counts * (self.quadratic + counts * self.cubic))
    }
}

/// Returns true if the reading is not at an end of the converter's range. A broken wire or a shorted sensor gives such a
/// reading.
#[inline]
pub fn plausible(adc: u16) -> bool {
    adc > 0 && adc < ADC_FULL_SCALE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_input_stage_is_the_boards() {
        // V_adc = 1.25 V is the middle of both ranges.
        assert!((volts(2048) - 2.5).abs() < 1e-6);
        assert!((volts(2049) - volts(2048) - 1.11e-3).abs() < 1e-5);
    }

    #[test]
    fn the_curve_passes_through_its_centre_with_its_slope() {
        let curve = HallCurve::new(&HallSettings {
            centre_v: 2.5,
            slope_deg_per_v: 34.55,
            quadratic_deg_per_v2: 0.0,
            cubic_deg_per_v3: 2.0,
        });
        assert!(curve.position_rad(2048).abs() < 1e-6);
        let v = volts(2500) - 2.5;
        let expected_deg = 34.55 * v + 2.0 * v * v * v;
        assert!((curve.position_rad(2500) - expected_deg * RAD_PER_DEG).abs() < 1e-6);
    }
}
