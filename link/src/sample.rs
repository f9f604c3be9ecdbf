//! What the control loop shows in one control period, and its short form.

use crate::{Channel, SAMPLE_BYTES};

/// A control period as the loop sees and leaves it. Positions, velocity, setpoint and torque change with every run of
/// the position loop, current and duty with every control period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Reference with the excitation on it: rad in position mode, N m at the motor in torque mode.
    pub setpoint: f32,
    /// By the encoder, unfiltered, rad.
    pub encoder_rad: f32,
    /// By the Hall sensor, unfiltered, rad.
    pub hall_rad: f32,
    /// By the controller's estimate, rad/s.
    pub velocity_rad_s: f32,
    /// That the controller asks for, N m at the motor.
    pub torque_nm: f32,
    /// Current of the motor, A.
    pub current_a: f32,
    /// Share of the supply on the motor, -1 to 1.
    pub duty: f32,
    /// 0 off, 1 idle, 2 torque, 3 position.
    pub mode: u8,
    /// 0 for none, else the number of the latched fault, from 1.
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

/// Values of the short form in the unit of the quantity: powers of two, so that the short form of a short form is the
/// same.
const PER_RAD: f32 = 16_384.0;
const PER_RAD_S: f32 = 512.0;
const PER_NM: f32 = 262_144.0;
const PER_A: f32 = 16_384.0;
const PER_DUTY: f32 = 32_768.0;
/// Torque mode, in which the setpoint is a torque.
const TORQUE_MODE: u8 = 2;

/// A [`Sample`] in 16 bits a value: ±2 rad in steps of 0.0035°, ±64 rad/s, ±125 mN m in steps of 0.004 mN m, ±2 A in
/// steps of 0.06 mA. What goes beyond stays at the end of its range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortSample([i16; SAMPLE_BYTES / 2]);

impl ShortSample {
    /// An empty sample that fills a memory.
    pub const NONE: Self = Self([0; SAMPLE_BYTES / 2]);

    /// For the wire.
    pub fn to_bytes(self) -> [u8; SAMPLE_BYTES] {
        let mut bytes = [0; SAMPLE_BYTES];
        let (places, _) = bytes.as_chunks_mut();
        for (place, value) in places.iter_mut().zip(self.0) {
            *place = value.to_le_bytes();
        }
        bytes
    }

    /// From the wire.
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

/// The nearest integer towards zero that 16 bits hold; 0 for NaN. By way of 32 bits, to which a Cortex-M4F converts in one
/// instruction and saturates in another.
#[inline]
fn short(value: f32) -> i16 {
    (value as i32).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

#[inline]
fn per_setpoint(mode: u8) -> f32 {
    if mode == TORQUE_MODE { PER_NM } else { PER_RAD }
}
