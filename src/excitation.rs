//! Excitation signals. They are generated on the device, so that simulation and hardware use the same signals.

use core::fmt;

use crate::phase::{self, Phase};

/// Number of harmonics of a multisine. All have the same amplitude.
pub const MULTISINE_HARMONICS: u32 = 6;
/// Peak of the sum of these unit sines with Schroeder's phases.
const MULTISINE_PEAK: f32 = 3.3155;
/// A ramp stops when the paddle has moved by this, rad (0.5 degrees).
const BREAKAWAY_RAD: f32 = 0.008_726_6;

/// Form of an excitation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Constant from the first tick.
    Step,
    /// Sine.
    Sine,
    /// Square wave.
    Square,
    /// Triangle wave.
    Triangle,
    /// Sine whose frequency changes linearly from `frequency_hz` to `end_frequency_hz` over the duration.
    Chirp,
    /// The first six harmonics of `frequency_hz` with equal amplitudes and Schroeder's phases, which give a low peak.
    Multisine,
    /// Linear from 0 to the amplitude over the duration, or until the paddle starts to move.
    Ramp,
}

impl Shape {
    /// All shapes with their names in the console.
    pub const NAMED: [(&'static str, Self); 7] = [
        ("step", Self::Step),
        ("sine", Self::Sine),
        ("square", Self::Square),
        ("triangle", Self::Triangle),
        ("chirp", Self::Chirp),
        ("multisine", Self::Multisine),
        ("ramp", Self::Ramp),
    ];
}

/// An excitation. Amplitude and offset are in the unit of the mode: rad in position mode, N m at the motor in torque mode.
/// They add to the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// Form.
    pub shape: Shape,
    /// Largest deviation from the offset.
    pub amplitude: f32,
    /// Constant part.
    pub offset: f32,
    /// Frequency, Hz: start frequency of a chirp, fundamental of a multisine. Unused for step and ramp.
    pub frequency_hz: f32,
    /// End frequency of a chirp, Hz.
    pub end_frequency_hz: f32,
    /// Duration, s. 0 = until stopped.
    pub duration_s: f32,
}

impl Excitation {
    /// A step by `amplitude` that lasts until stopped.
    pub const fn step(amplitude: f32) -> Self {
        Self {
            shape: Shape::Step,
            amplitude,
            offset: 0.0,
            frequency_hz: 0.0,
            end_frequency_hz: 0.0,
            duration_s: 0.0,
        }
    }

    /// Checks that the signal is sensible for a paddle. The position loop follows up to about 20 Hz. At 100 Hz the largest
    /// motor torque moves the paddle by a tenth of a degree.
    ///
    /// # Errors
    ///
    /// [`ExcitationError::TooFast`] above 500 Hz, and [`ExcitationError::Endless`] above 50 Hz without an end within a
    /// minute.
    pub fn check_sense(&self) -> Result<(), ExcitationError> {
        const FASTEST_HZ: f32 = 500.0;
        const FASTEST_ENDLESS_HZ: f32 = 50.0;
        const LONGEST_FAST_S: f32 = 60.0;
        let highest_hz = match self.shape {
            Shape::Step | Shape::Ramp => 0.0,
            Shape::Sine | Shape::Square | Shape::Triangle => self.frequency_hz,
            Shape::Chirp => self.frequency_hz.max(self.end_frequency_hz),
            Shape::Multisine => self.frequency_hz * MULTISINE_HARMONICS as f32,
        };
        let ends = self.duration_s > 0.0 && self.duration_s <= LONGEST_FAST_S;
        if highest_hz > FASTEST_HZ {
            Err(ExcitationError::TooFast)
        } else if highest_hz > FASTEST_ENDLESS_HZ && !ends {
            Err(ExcitationError::Endless)
        } else {
            Ok(())
        }
    }

    /// A sine that lasts until stopped.
    pub const fn sine(amplitude: f32, frequency_hz: f32) -> Self {
        Self {
            shape: Shape::Sine,
            frequency_hz,
            ..Self::step(amplitude)
        }
    }
}

/// Why an excitation cannot start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExcitationError {
    /// A number is negative where it must not be, or not finite.
    BadNumber,
    /// A chirp or a ramp needs a duration for its slope.
    NeedsDuration,
    /// The frequency is above half the rate of the position loop, or it is 0 for a periodic signal.
    BadFrequency,
    /// The paddle cannot follow the frequency.
    TooFast,
    /// A fast signal needs a duration.
    Endless,
    /// Together with the reference, the signal exceeds the travel or the torque limit.
    OutOfRange,
    /// The controller is off.
    Disarmed,
}

impl fmt::Display for ExcitationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::BadNumber => "excitation needs finite numbers, and a duration of 0 or more",
            Self::NeedsDuration => "chirp and ramp need a duration above 0 s",
            Self::BadFrequency => {
                "frequency must be above 0 and below half the rate of the position loop"
            }
            Self::TooFast => {
                "no paddle follows more than 500 Hz (a multisine goes up to six times its frequency)"
            }
            Self::Endless => "above 50 Hz say for how many seconds, 60 at most",
            Self::OutOfRange => {
                "reference, offset and amplitude together are beyond limit.travel or motor.torque_limit"
            }
            Self::Disarmed => "arm before starting an excitation",
        })
    }
}

impl core::error::Error for ExcitationError {}

/// Generates one [`Excitation`].
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    shape: Shape,
    amplitude: f32,
    offset: f32,
    phase: u64,
    increment: i64,
    sweep: i64,
    tick: u32,
    ticks: u32,
    per_tick: f32,
    started_at_rad: Option<f32>,
    breakaway: Option<f32>,
}

impl Generator {
    /// A generator for ticks of `tick_s`.
    ///
    /// # Errors
    ///
    /// [`ExcitationError`] for invalid parameters.
    pub fn new(excitation: &Excitation, tick_s: f32) -> Result<Self, ExcitationError> {
        let &Excitation {
            shape,
            amplitude,
            offset,
            frequency_hz,
            end_frequency_hz,
            duration_s,
        } = excitation;
        let finite = [
            amplitude,
            offset,
            frequency_hz,
            end_frequency_hz,
            duration_s,
        ]
        .iter()
        .all(|x| x.is_finite());
        if !finite || duration_s < 0.0 {
            return Err(ExcitationError::BadNumber);
        }
        let ticks = (duration_s / tick_s + 0.5) as u32;
        if ticks == 0 && matches!(shape, Shape::Chirp | Shape::Ramp) {
            return Err(ExcitationError::NeedsDuration);
        }
        let below_nyquist = |f_hz: f32| f_hz > 0.0 && f_hz * tick_s < 0.5;
        let frequencies_fit = match shape {
            Shape::Step | Shape::Ramp => true,
            Shape::Chirp => below_nyquist(frequency_hz) && below_nyquist(end_frequency_hz),
            Shape::Multisine => below_nyquist(frequency_hz * MULTISINE_HARMONICS as f32),
            Shape::Sine | Shape::Square | Shape::Triangle => below_nyquist(frequency_hz),
        };
        if !frequencies_fit {
            return Err(ExcitationError::BadFrequency);
        }
        let increment = phase::increment(frequency_hz, tick_s);
        let sweep = match shape {
            Shape::Chirp => {
                let rise = phase::increment(end_frequency_hz, tick_s) - increment;
                rise.checked_div(i64::from(ticks)).unwrap_or(0)
            }
            _ => 0,
        };
        let per_tick = if shape == Shape::Ramp {
            amplitude / ticks as f32
        } else {
            0.0
        };
        Ok(Self {
            shape,
            amplitude,
            offset,
            phase: 0,
            increment,
            sweep,
            tick: 0,
            ticks,
            per_tick,
            started_at_rad: None,
            breakaway: None,
        })
    }

    /// The value for this tick. `None` after the end. `position_rad` is the present position of the paddle.
    #[inline]
    pub fn next(&mut self, position_rad: f32) -> Option<f32> {
        if self.breakaway.is_some() || (self.ticks != 0 && self.tick >= self.ticks) {
            return None;
        }
        let phase = Phase((self.phase >> 32) as u32);
        let wave = match self.shape {
            Shape::Step => self.amplitude,
            Shape::Sine | Shape::Chirp => self.amplitude * phase.sin(),
            Shape::Square => self.amplitude * phase.square(),
            Shape::Triangle => self.amplitude * phase.triangle(),
            Shape::Multisine => self.amplitude * multisine(phase),
            Shape::Ramp => {
                let wave = self.per_tick * self.tick as f32;
                let started_at_rad = *self.started_at_rad.get_or_insert(position_rad);
                if (position_rad - started_at_rad).abs() > BREAKAWAY_RAD {
                    self.breakaway = Some(self.offset + wave);
                    return None;
                }
                wave
            }
        };
        self.phase = self.phase.wrapping_add_signed(self.increment);
        self.increment = self.increment.wrapping_add(self.sweep);
        if self.ticks != 0 {
            self.tick += 1;
        }
        Some(self.offset + wave)
    }

    /// The value of a ramp at which the paddle started to move.
    pub fn breakaway(&self) -> Option<f32> {
        self.breakaway
    }
}

/// Sum of the harmonics, at most 1. Schroeder's phases for a flat spectrum are -pi k (k - 1) / N (IEEE Transactions on
/// Information Theory 16, 1970, p. 85).
///
/// The sum is the imaginary part of a polynomial in exp(i phase). Horner's scheme needs only one sine and one cosine.
#[inline]
fn multisine(phase: Phase) -> f32 {
    const HALF_ROOT_3: f32 = 0.866_025_4;
    /// Cosine and sine of the phases, from the first harmonic to the last.
    const PHASES: [(f32, f32); MULTISINE_HARMONICS as usize] = [
        (1.0, 0.0),
        (0.5, -HALF_ROOT_3),
        (-1.0, 0.0),
        (1.0, 0.0),
        (-0.5, HALF_ROOT_3),
        (-1.0, 0.0),
    ];
    let (cos, sin) = phase.cos_sin();
    let [lower @ .., highest] = PHASES;
    let (re, im) = lower.iter().rev().fold(highest, |(re, im), phase| {
        (re * cos - im * sin + phase.0, re * sin + im * cos + phase.1)
    });
    (re * sin + im * cos) * (1.0 / MULTISINE_PEAK)
}
