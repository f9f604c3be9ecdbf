//! What a user can choose by name.

/// A setting that is one of some names.
pub trait Choice: Copy + Default + PartialEq + 'static {
    /// The names, in the order of [`Self::ALL`].
    const NAMES: &'static [&'static str];
    /// All values.
    const ALL: &'static [Self];

    /// Place of this value among [`Self::ALL`].
    fn index(self) -> usize {
        let is_this = |value: &Self| *value == self;
        Self::ALL.iter().position(is_this).unwrap_or_default()
    }
}

macro_rules! names {
    ($Choice:ty: $($name:literal => $value:expr),+) => {
        impl Choice for $Choice {
            const NAMES: &'static [&'static str] = &[$($name),+];
            const ALL: &'static [Self] = &[$($value),+];
        }
    };
}

names!(bool: "off" => false, "on" => true);
names!(Sensor: "encoder" => Self::Encoder, "hall" => Self::Hall);
names!(VelocitySource: "measured" => Self::Measured, "setpoint" => Self::Setpoint);
names!(DerivativeSource: "auto" => Self::Auto, "position" => Self::Position, "observer" => Self::Observer);
names!(CurrentSampling: "mean" => Self::Mean, "centre" => Self::Centre);
names!(FilterOrder: "first" => Self::First, "second" => Self::Second);

/// Sensor that feeds the regulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensor {
    /// Incremental encoder on the motor.
    #[default]
    Encoder,
    /// Hall sensor on the paddle.
    Hall,
}

/// Velocity that drives the compensation of dry friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VelocitySource {
    /// The observer's. Near rest this takes damping away: 0.585 mN m at the motor over 10 degrees a second are
    /// -0.050 N m s/rad at the paddle, as much as the default gains give. It needs a wide band, or gains that damp more.
    Measured,
    /// That of the setpoint: helps a motion that is wanted, and cannot make one. Torque mode, which has no such motion,
    /// is then not compensated.
    #[default]
    Setpoint,
}

/// What the derivative of the position regulator is taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DerivativeSource {
    /// The observer with the Hall sensor, whose noise it cuts to an eighth (1.0 to 0.12 mN m rms at the default gains),
    /// and differences with the encoder, which has none: a step of 5 degrees then settles in 63 ms instead of 78.
    #[default]
    Auto,
    /// Differences of the filtered position, the lab's.
    Position,
    /// The observer, which knows the torque.
    Observer,
}

impl DerivativeSource {
    /// Whether it is the observer with this sensor.
    pub fn is_observer(self, sensor: Sensor) -> bool {
        match self {
            Self::Auto => sensor == Sensor::Hall,
            Self::Position => false,
            Self::Observer => true,
        }
    }
}

/// What the current loop takes for the current of a control period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurrentSampling {
    /// The mean over the period: rejects the amplifier's noise.
    #[default]
    Mean,
    /// One sample at the centre of the PWM.
    Centre,
}

/// Order of the low-pass on the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterOrder {
    /// First order, the lab's.
    #[default]
    First,
    /// Second order, Butterworth.
    Second,
}
