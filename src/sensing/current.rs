//! Motor current from a shunt amplifier that rests at half scale.

use core::fmt;

use super::ADC_VOLTS_PER_COUNT;
use crate::decimal::Fixed;

const SHUNT_OHM: f32 = 0.025;
const AMPLIFIER_GAIN: f32 = 30.0;
const AMPERES_PER_COUNT: f32 = ADC_VOLTS_PER_COUNT / (SHUNT_OHM * AMPLIFIER_GAIN);

/// Offset of an ideal amplifier, ADC counts.
const NOMINAL_OFFSET_COUNTS: f32 = 2048.0;
/// An offset farther than this from the nominal one, ADC counts, is a fault of the board and not of the amplifier.
const OFFSET_TOLERANCE_COUNTS: f32 = 512.0;

/// The amplifier's reading as a current, positive where the torque is positive.
#[derive(Clone, Copy, Debug)]
pub struct CurrentSensor {
    offset_counts: f32,
}

impl Default for CurrentSensor {
    fn default() -> Self {
        Self {
            offset_counts: NOMINAL_OFFSET_COUNTS,
        }
    }
}

impl CurrentSensor {
    /// Takes the mean reading at rest, ADC counts, as the new offset.
    ///
    /// # Errors
    /// [`OffsetError`], and the old offset stays, if the reading cannot be that of an idle bridge.
    pub fn calibrate(&mut self, idle_counts: f32) -> Result<(), OffsetError> {
        let deviation = (idle_counts - NOMINAL_OFFSET_COUNTS).abs();
        if deviation <= OFFSET_TOLERANCE_COUNTS {
            self.offset_counts = idle_counts;
            Ok(())
        } else {
            Err(OffsetError { idle_counts })
        }
    }

    /// Current, A, from the mean reading of a period in ADC counts.
    ///
    /// On the board torque = -Kt i_measured. The sign is turned here, so that everywhere else torque = +Kt i.
    #[inline]
    pub fn amperes(&self, mean_counts: f32) -> f32 {
        (self.offset_counts - mean_counts) * AMPERES_PER_COUNT
    }
}

/// The current amplifier does not rest near half scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetError {
    /// What it reads instead, ADC counts.
    pub idle_counts: f32,
}

impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "current amplifier reads {} counts at rest, not {} +- {}: \
             is current flowing, or the shunt amplifier broken?",
            Fixed(self.idle_counts, 0),
            Fixed(NOMINAL_OFFSET_COUNTS, 0),
            Fixed(OFFSET_TOLERANCE_COUNTS, 0),
        )
    }
}

impl core::error::Error for OffsetError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positive_torque_lowers_the_reading() {
        let mut sensor = CurrentSensor::default();
        sensor.calibrate(2100.0).unwrap();
        assert_eq!(sensor.amperes(2100.0), 0.0);
        // 0.75 V/A on 0.61 mV a count.
        assert!((sensor.amperes(2100.0 - 1228.8) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn an_impossible_offset_is_refused_and_the_old_one_kept() {
        let mut sensor = CurrentSensor::default();
        for counts in [0.0, 4095.0, f32::NAN, f32::INFINITY] {
            assert!(sensor.calibrate(counts).is_err());
        }
        assert_eq!(sensor.amperes(2048.0), 0.0);
    }
}
