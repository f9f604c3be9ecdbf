//! Motor current from a shunt amplifier that rests at half scale.

use core::fmt;

use super::ADC_VOLTS_PER_COUNT;
use crate::decimal::Fixed;

const SHUNT_OHM: f32 = 0.025;
const AMPLIFIER_GAIN: f32 = 30.0;
const AMPERES_PER_COUNT: f32 = ADC_VOLTS_PER_COUNT / (SHUNT_OHM * AMPLIFIER_GAIN);

/// Offset of an ideal amplifier, counts of the converter.
const NOMINAL_OFFSET_COUNTS: f32 = 2048.0;
/// What the parts' tolerances allow either side of it, counts, 52 mA: 20 for a middle made by two resistors of 1 %, 25
/// for 0.5 mV of offset at the amplifier's input, 3 for the converter's own, and a quarter more.
const OFFSET_TOLERANCE_COUNTS: f32 = 64.0;
/// Deviation of the means of control periods, counts rms, above which the bridge is not at rest. The amplifier's noise
/// leaves one.
const RESTLESS_COUNTS: f32 = 8.0;
/// An amplifier comes no nearer than this to the ends of the converter's range, counts (29 mV); what is nearer is not
/// measured.
const RAIL_COUNTS: f32 = 48.0;
/// Highest reading of the converter.
const FULL_SCALE_COUNTS: f32 = 4095.0;

/// Largest current, A, of either sign that is measured whatever offset was accepted.
pub const MEASURABLE_A: f32 = 1.55;

/// Whether a mean reading is between the ends of its range; a number that is not finite is not.
#[inline]
pub fn plausible(mean_counts: f32) -> bool {
    const MIDDLE: f32 = 0.5 * FULL_SCALE_COUNTS;
    (mean_counts - MIDDLE).abs() < MIDDLE - RAIL_COUNTS
}

/// Readings of a bridge at no voltage, one a control period.
#[derive(Clone, Copy, Debug, Default)]
pub struct IdleReading {
    periods: f32,
    /// Sums of the deviation from the nominal offset, counts, and of its square.
    sum: f32,
    squares: f32,
}

impl IdleReading {
    /// Takes the mean reading of a control period, counts.
    #[inline]
    pub fn add(&mut self, mean_counts: f32) {
        let deviation = mean_counts - NOMINAL_OFFSET_COUNTS;
        self.periods += 1.0;
        self.sum += deviation;
        self.squares += deviation * deviation;
    }

    /// Control periods so far.
    pub fn periods(&self) -> f32 {
        self.periods
    }
}

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
    /// Takes the mean of the readings at rest as the new offset.
    ///
    /// # Errors
    /// [`OffsetError`], and the old offset stays, if the readings cannot be those of an idle bridge.
    pub fn calibrate(&mut self, idle: &IdleReading) -> Result<(), OffsetError> {
        let mean = idle.sum / idle.periods;
        let variance = idle.squares / idle.periods - mean * mean;
        if mean.is_nan() || mean.abs() > OFFSET_TOLERANCE_COUNTS {
            Err(OffsetError::Far {
                counts: NOMINAL_OFFSET_COUNTS + mean,
            })
        } else if variance > RESTLESS_COUNTS * RESTLESS_COUNTS {
            Err(OffsetError::Restless)
        } else {
            self.offset_counts = NOMINAL_OFFSET_COUNTS + mean;
            Ok(())
        }
    }

    /// The offset as a current, A, against half scale, with the sign of the measured current.
    pub fn offset_a(&self) -> f32 {
        (NOMINAL_OFFSET_COUNTS - self.offset_counts) * AMPERES_PER_COUNT
    }

    /// Current, A, from the mean reading of a period in counts.
    ///
    /// On the board torque = -Kt i_measured. The sign is turned here, so that everywhere else torque = +Kt i.
    #[inline]
    pub fn amperes(&self, mean_counts: f32) -> f32 {
        (self.offset_counts - mean_counts) * AMPERES_PER_COUNT
    }
}

/// Why the current amplifier's offset is not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetError {
    /// It is farther from half scale than its parts' tolerances allow.
    Far {
        /// The reading at rest, counts.
        counts: f32,
    },
    /// The reading does not rest.
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
        // 0.75 V/A on 0.61 mV a count.
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
    fn readings_that_do_not_rest_are_refused() {
        let mut reading = IdleReading::default();
        for period in 0..100 {
            reading.add(2048.0 + if period % 2 == 0 { 10.0 } else { -10.0 });
        }
        let refused = CurrentSensor::default().calibrate(&reading);
        assert_eq!(refused, Err(OffsetError::Restless));
    }

    #[test]
    fn what_is_measurable_is_so_at_the_farthest_offset_accepted() {
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
