//! The quantities of one control period, and their short form.

use crate::{Channel, SAMPLE_BYTES};

/// The quantities of one control period. Positions, velocity, setpoint and torque change with every run of the position
/// loop. Current and duty change in every control period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Setpoint including the excitation: rad in position mode, N m at the motor in torque mode.
    pub setpoint: f32,
    /// Unfiltered position of the encoder, rad.
    pub encoder_rad: f32,
    /// Unfiltered position of the Hall sensor, rad.
    pub hall_rad: f32,
    /// Estimated velocity, rad/s.
    pub velocity_rad_s: f32,
    /// Commanded torque, N m at the motor.
    pub torque_nm: f32,
    /// Current of the motor, A.
    pub current_a: f32,
    /// Duty of the bridge, -1 to 1.
    pub duty: f32,
    /// Mode: 0 off, 1 idle, 2 torque, 3 position.
    pub mode: u8,
    /// 0 for no fault, otherwise the number of the latched fault, from 1.
    pub fault: u8,
}

impl Sample {
    /// The value of a channel, in its unit.
    pub fn value(&self, channel: Channel) -> f32 {
        match channel {
            Channel::Setpoint => self.setpoint,
            Channel::Encoder => self.encoder_rad,
            Channel::Hall => self.hall_rad,
            Channel::Velocity => self.velocity_rad_s,
            Channel::Torque => self.torque_nm,
            Channel::Current => self.current_a,
            Channel::Duty => self.duty,
            Channel::Mode => f32::from(self.mode),
            Channel::Fault => f32::from(self.fault),
        }
    }
}

/// Scale factors of the short form. They are powers of two, so that converting a short form again changes nothing.
const PER_RAD: f32 = 16_384.0;
const PER_RAD_S: f32 = 512.0;
const PER_NM: f32 = 262_144.0;
const PER_A: f32 = 16_384.0;
const PER_DUTY: f32 = 32_768.0;
/// Number of torque mode, in which the setpoint is a torque.
const TORQUE_MODE: u8 = 2;

/// A [`Sample`] with 16 bits per value: ±2 rad in steps of 0.0035°, ±64 rad/s, ±125 mN m in steps of 0.004 mN m, ±2 A in
/// steps of 0.06 mA. Larger values are limited to the range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortSample([i16; SAMPLE_BYTES / 2]);

impl ShortSample {
    /// An empty sample, for initialising a memory.
    pub const NONE: Self = Self([0; SAMPLE_BYTES / 2]);

    /// Encodes the sample.
    pub fn to_bytes(self) -> [u8; SAMPLE_BYTES] {
        let mut bytes = [0; SAMPLE_BYTES];
        let (places, _) = bytes.as_chunks_mut();
        for (place, value) in places.iter_mut().zip(self.0) {
            *place = value.to_le_bytes();
        }
        bytes
    }

    /// Decodes the sample.
    pub fn from_bytes(bytes: [u8; SAMPLE_BYTES]) -> Self {
        let mut values = [0; SAMPLE_BYTES / 2];
        let (words, _) = bytes.as_chunks();
        for (value, word) in values.iter_mut().zip(words) {
            *value = i16::from_le_bytes(*word);
        }
        Self(values)
    }
}

impl From<&Sample> for ShortSample {
    #[inline]
    fn from(sample: &Sample) -> Self {
        Self([
            short(sample.setpoint * per_setpoint(sample.mode)),
            short(sample.encoder_rad * PER_RAD),
            short(sample.hall_rad * PER_RAD),
            short(sample.velocity_rad_s * PER_RAD_S),
            short(sample.torque_nm * PER_NM),
            short(sample.current_a * PER_A),
            short(sample.duty * PER_DUTY),
            i16::from_le_bytes([sample.mode, sample.fault]),
        ])
    }
}

impl From<ShortSample> for Sample {
    fn from(ShortSample(values): ShortSample) -> Self {
        let [
            setpoint,
            encoder,
            hall,
            velocity,
            torque,
            current,
            duty,
            state,
        ] = values;
        let [mode, fault] = state.to_le_bytes();
        Self {
            setpoint: f32::from(setpoint) / per_setpoint(mode),
            encoder_rad: f32::from(encoder) / PER_RAD,
            hall_rad: f32::from(hall) / PER_RAD,
            velocity_rad_s: f32::from(velocity) / PER_RAD_S,
            torque_nm: f32::from(torque) / PER_NM,
            current_a: f32::from(current) / PER_A,
            duty: f32::from(duty) / PER_DUTY,
            mode,
            fault,
        }
    }
}

/// The value rounded towards zero and limited to 16 bits. NaN gives 0. The conversion goes through `i32`: a Cortex-M4F
/// converts to it in one instruction and saturates in another.
#[inline]
fn short(value: f32) -> i16 {
    (value as i32).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

#[inline]
fn per_setpoint(mode: u8) -> f32 {
    if mode == TORQUE_MODE { PER_NM } else { PER_RAD }
}
