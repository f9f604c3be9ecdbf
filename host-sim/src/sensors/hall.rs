//! Hall sensor opposite a magnet on the paddle, with its converter.

use crate::sensing::{Reading, Sensing};
use crate::sensors::Noise;
use haptic_paddle::sensing::hall::{ADC_FULL_SCALE, volts};
use haptic_paddle::settings::HallSettings;

/// Errors and scale of the Hall sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Hall {
    /// Deviation from the linear calibration: gain, nonlinearity, play and lag.
    pub sensing: Sensing,
    /// Hall voltage at 0 rad.
    pub centre_v: f64,
    /// Slope at 0 rad, V/rad.
    pub volts_per_rad: f64,
    /// Noise before the converter, V rms.
    pub noise_v: f64,
}

/// Measured at rest on the lab's paddle, V rms.
const NOISE_V: f64 = 0.79e-3;

impl Hall {
    /// A sensor that matches the linear part of this calibration, with the lab's noise.
    pub fn calibrated(settings: &HallSettings) -> Self {
        Self {
            sensing: Sensing::ideal(),
            centre_v: f64::from(settings.centre_v),
            volts_per_rad: 1.0 / f64::from(settings.slope_deg_per_v).to_radians(),
            noise_v: NOISE_V,
        }
    }

    /// Angle per count of the converter, rad.
    pub fn resolution_rad(&self) -> f64 {
        volts_per_count() / self.volts_per_rad.abs()
    }

    /// Noise before the converter, rad rms.
    pub fn noise_rad(&self) -> f64 {
        self.noise_v / self.volts_per_rad.abs()
    }
}

/// Volts at the output of the Hall sensor per count of the converter.
fn volts_per_count() -> f64 {
    f64::from(volts(ADC_FULL_SCALE) - volts(0)) / f64::from(ADC_FULL_SCALE)
}

/// State of the Hall sensor.
#[derive(Clone, Debug)]
pub struct HallReader {
    hall: Hall,
    reading: Reading,
    volts_at_count_0: f64,
    counts_per_volt: f64,
}

impl HallReader {
    /// The sensor at rest at `position_rad`.
    pub fn at_rest(hall: Hall, position_rad: f64) -> Self {
        Self {
            reading: Reading::at_rest(&hall.sensing, position_rad),
            volts_at_count_0: f64::from(volts(0)),
            counts_per_volt: 1.0 / volts_per_count(),
            hall,
        }
    }

    /// The converter's count at `position_rad`, `dt_s` after the last call.
    #[inline]
    pub fn count(&mut self, position_rad: f64, dt_s: f64, noise: &mut Noise) -> u16 {
        let angle = self.reading.follow(&self.hall.sensing, position_rad, dt_s);
        let volts =
            self.hall.centre_v + self.hall.volts_per_rad * angle + noise.next(self.hall.noise_v);
        // Rounds half up. The cast saturates at 0, like the converter.
        let count = ((volts - self.volts_at_count_0) * self.counts_per_volt + 0.5) as u16;
        count.min(ADC_FULL_SCALE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_paddle::sensing::hall::HallCurve;

    #[test]
    fn the_core_reads_the_angle_back_within_half_a_count() {
        let settings = HallSettings::default();
        let mut hall = Hall::calibrated(&settings);
        hall.noise_v = 0.0;
        let half = 0.5 * hall.resolution_rad() + 1e-6;
        let curve = HallCurve::new(&settings);
        let mut reader = HallReader::at_rest(hall, 0.0);
        for i in -60..=60 {
            let angle = f64::from(i) * 0.01;
            let adc = reader.count(angle, 1e-3, &mut Noise::new(0));
            assert!((f64::from(curve.position_rad(adc)) - angle).abs() <= half);
        }
    }

    #[test]
    fn the_converter_saturates() {
        let mut reader = HallReader::at_rest(Hall::calibrated(&HallSettings::default()), 0.0);
        let noise = &mut Noise::new(0);
        assert_eq!(reader.count(10.0, 1e-3, noise), ADC_FULL_SCALE);
        assert_eq!(reader.count(-10.0, 1e-3, noise), 0);
    }
}
