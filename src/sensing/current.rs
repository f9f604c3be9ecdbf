//! Motor current from a shunt amplifier whose output at zero current is half scale.

use core::fmt;

use super::ADC_VOLTS_PER_COUNT;
use crate::decimal::Fixed;

const SHUNT_OHM: f32 = 0.025;
const AMPLIFIER_GAIN: f32 = 30.0;
const AMPERES_PER_COUNT: f32 = ADC_VOLTS_PER_COUNT / (SHUNT_OHM * AMPLIFIER_GAIN);

/// Offset of an ideal amplifier, counts of the converter.
const NOMINAL_OFFSET_COUNTS: f32 = 2048.0;
/// Largest accepted deviation of the offset, counts (52 mA). It is the sum of 20 for a divider of two 1 % resistors, 25 for
/// 0.5 mV of input offset of the amplifier, and 3 for the converter, plus a quarter.
const OFFSET_TOLERANCE_COUNTS: f32 = 64.0;
/// Standard deviation of the means of control periods above which the bridge is not at rest, counts. The noise of the
/// amplifier gives 1.
const RESTLESS_COUNTS: f32 = 8.0;
/// Margin from the ends of the converter's range within which a reading is not valid, counts (29 mV). The output of the
/// amplifier does not come closer to its rails.
const RAIL_COUNTS: f32 = 48.0;
/// Highest result of the converter.
const FULL_SCALE_COUNTS: f32 = 4095.0;

/// Largest current of either sign that can be measured with any accepted offset, A.
pub const MEASURABLE_A: f32 = 1.55;

/// Returns true if a mean reading is within the valid range. A non-finite number is not.
#[inline]
pub fn plausible(mean_counts: f32) -> bool {
    const MIDDLE: f32 = 0.5 * FULL_SCALE_COUNTS;
    (mean_counts - MIDDLE).abs() < MIDDLE - RAIL_COUNTS
}

/// Statistics of the current readings at zero voltage, with one reading per control period.
#[derive(Clone, Copy, Debug, Default)]
pub struct IdleReading {
    periods: f32,
    /// The first reading, counts. The sums of the deviations from it are exact for readings that do not vary.
    first: f32,
    /// Sum of the deviations from the first reading, counts.
    sum: f32,
    squares: f32,
}

impl IdleReading {
    /// Adds the mean reading of a control period, counts.
    #[inline]
    pub fn add(&mut self, mean_counts: f32) {
        if self.periods == 0.0 {
            self.first = mean_counts;
        }
        let deviation = mean_counts - self.first;
        self.periods += 1.0;
        self.sum += deviation;
        self.squares += deviation * deviation;
    }

    /// Number of control periods so far.
    pub fn periods(&self) -> f32 {
        self.periods
    }
}

/// Converts readings of the amplifier to the motor current. A positive current gives a positive torque.
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
    /// Takes the mean of the readings as the new offset.
    ///
    /// # Errors
    ///
    /// [`OffsetError`] if the readings cannot be those of an idle bridge. The old offset is kept.
    pub fn calibrate(&mut self, idle: &IdleReading) -> Result<(), OffsetError> {
        let above_first = idle.sum / idle.periods;
        let variance = idle.squares / idle.periods - above_first * above_first;
        let mean = idle.first - NOMINAL_OFFSET_COUNTS + above_first;
        // A moving motor drives a current through the shorted bridge, so motion is excluded first.
        if variance > RESTLESS_COUNTS * RESTLESS_COUNTS {
            Err(OffsetError::Restless)
        } else if mean.is_nan() || mean.abs() > OFFSET_TOLERANCE_COUNTS {
            Err(OffsetError::Far {
                counts: NOMINAL_OFFSET_COUNTS + mean,
            })
        } else {
            self.offset_counts = NOMINAL_OFFSET_COUNTS + mean;
            Ok(())
        }
    }

    /// The offset as a current, A, relative to half scale, with the sign of the measured current.
    pub fn offset_a(&self) -> f32 {
        (NOMINAL_OFFSET_COUNTS - self.offset_counts) * AMPERES_PER_COUNT
    }

    /// Current, A, from the mean reading of a period in counts.
    ///
    /// On the board, torque = -Kt i_measured. The sign is changed here, so that torque = +Kt i everywhere else.
    #[inline]
    pub fn amperes(&self, mean_counts: f32) -> f32 {
        (self.offset_counts - mean_counts) * AMPERES_PER_COUNT
    }
}

/// Why the offset of the current amplifier is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetError {
    /// It differs from half scale by more than the tolerances of the parts.
    Far {
        /// The mean reading, counts.
        counts: f32,
    },
    /// The readings vary too much.
    Restless,
}

impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Far { counts } => write!(
                f,
                "current amplifier reads {} counts at rest, not {} +- {}: \
                 is current flowing, or the shunt amplifier broken?",
                Fixed(*counts, 0),
                Fixed(NOMINAL_OFFSET_COUNTS, 0),
                Fixed(OFFSET_TOLERANCE_COUNTS, 0),
            ),
            Self::Restless => f.write_str(
                "the current amplifier's reading does not rest: hold the paddle still, or check the amplifier",
            ),
        }
    }
}

impl core::error::Error for OffsetError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn idle(counts: f32) -> IdleReading {
        let mut reading = IdleReading::default();
        (0..100).for_each(|_| reading.add(counts));
        reading
    }

    #[test]
    fn positive_torque_lowers_the_reading() {
        let mut sensor = CurrentSensor::default();
        sensor.calibrate(&idle(2100.0)).unwrap();
        assert_eq!(sensor.amperes(2100.0), 0.0);
        // 0.75 V/A, with 0.61 mV per count.
        assert!((sensor.amperes(2100.0 - 1228.8) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn an_impossible_offset_is_refused_and_the_old_one_kept() {
        let mut sensor = CurrentSensor::default();
        for counts in [0.0, 1983.0, 2113.0, 4095.0, f32::NAN, f32::INFINITY] {
            assert!(sensor.calibrate(&idle(counts)).is_err(), "{counts}");
        }
        assert_eq!(sensor.amperes(2048.0), 0.0);
        assert!(
            sensor.calibrate(&IdleReading::default()).is_err(),
            "nothing"
        );
    }

    #[test]
    fn a_braking_motor_is_restless_and_not_a_broken_amplifier() {
        let mut reading = IdleReading::default();
        for period in 0..400 {
            reading.add(2048.0 - 400.0 * (-0.01 * period as f32).exp());
        }
        let refused = CurrentSensor::default().calibrate(&reading);
        assert_eq!(refused, Err(OffsetError::Restless));
    }

    #[test]
    fn a_steady_reading_far_off_is_not_restless() {
        let refused = CurrentSensor::default().calibrate(&idle(4000.0));
        assert_eq!(refused, Err(OffsetError::Far { counts: 4000.0 }));
    }

    #[test]
    fn readings_that_vary_too_much_are_refused() {
        let mut reading = IdleReading::default();
        for period in 0..100 {
            reading.add(2048.0 + if period % 2 == 0 { 10.0 } else { -10.0 });
        }
        let refused = CurrentSensor::default().calibrate(&reading);
        assert_eq!(refused, Err(OffsetError::Restless));
    }

    #[test]
    fn the_measurable_current_is_valid_at_the_largest_accepted_offset() {
        for offset in [-OFFSET_TOLERANCE_COUNTS, OFFSET_TOLERANCE_COUNTS] {
            let mut sensor = CurrentSensor::default();
            sensor
                .calibrate(&idle(NOMINAL_OFFSET_COUNTS + offset))
                .unwrap();
            for current_a in [-MEASURABLE_A, MEASURABLE_A] {
                let counts = sensor.offset_counts - current_a / AMPERES_PER_COUNT;
                assert!(plausible(counts), "{counts}");
            }
        }
    }
}
