//! The table of settings: name, unit, bounds, and how to read and write each. Console, command line and files
//! all go through it.

use core::fmt;

use super::{CurrentSampling, DerivativeSource, FilterOrder, Sensor, Settings, VelocitySource};
use crate::decimal::{self, Decimal};

/// What a setting may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number from `min` to `max`.
    Number {
        /// Least value.
        min: f32,
        /// Greatest value.
        max: f32,
    },
    /// One of these names; the value is its index.
    Choice(&'static [&'static str]),
}

/// One setting.
#[derive(Debug)]
pub struct Field {
    /// Full name, with dots.
    pub name: &'static str,
    /// Short name, where there is one.
    pub short: Option<&'static str>,
    /// Unit of the value; empty for none.
    pub unit: &'static str,
    /// What it may be.
    pub kind: Kind,
    read: fn(&Settings) -> f32,
    write: fn(&mut Settings, f32),
}

impl Field {
    /// The field of this full or short name.
    ///
    /// # Errors
    /// [`SettingError::Unknown`].
    pub fn find(name: &str) -> Result<&'static Self, SettingError> {
        FIELDS
            .iter()
            .find(|field| field.name == name || field.short == Some(name))
            .ok_or(SettingError::Unknown)
    }

    /// The value, in [`Self::unit`]; of a choice, its index.
    pub fn read(&self, settings: &Settings) -> f32 {
        (self.read)(settings)
    }

    /// The value by default.
    pub fn default_value(&self) -> f32 {
        self.read(&Settings::default())
    }

    /// Sets the value.
    ///
    /// # Errors
    /// [`SettingError`], and nothing changes, for a value outside the bounds, NaN included.
    pub fn write(&'static self, settings: &mut Settings, value: f32) -> Result<(), SettingError> {
        self.check(value)?;
        (self.write)(settings, value);
        Ok(())
    }

    /// The value that a text stands for: a number, or the name of a choice.
    ///
    /// # Errors
    /// [`SettingError`] for a text that is neither, or a value outside the bounds.
    pub fn parse(&'static self, text: &str) -> Result<f32, SettingError> {
        let named = match self.kind {
            Kind::Choice(names) => names
                .iter()
                .position(|name| *name == text)
                .map(|index| index as f32),
            Kind::Number { .. } => None,
        };
        let value = match named {
            Some(index) => index,
            None => decimal::parse(text).ok_or_else(|| self.refusal())?,
        };
        self.check(value)?;
        Ok(value)
    }

    fn check(&'static self, value: f32) -> Result<(), SettingError> {
        let fits = match self.kind {
            Kind::Number { min, max } => value >= min && value <= max,
            Kind::Choice(names) => (0..names.len()).any(|index| index as f32 == value),
        };
        if fits { Ok(()) } else { Err(self.refusal()) }
    }

    fn refusal(&'static self) -> SettingError {
        match self.kind {
            Kind::Number { .. } => SettingError::OutOfRange(self),
            Kind::Choice(_) => SettingError::NotAChoice(self),
        }
    }

    /// Name, value and unit as one shows them to people.
    pub fn shown(&'static self, settings: &Settings) -> Shown {
        Shown {
            field: self,
            value: self.read(settings),
        }
    }
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// A setting with its value; its `Display` is `pid.kp = 0.05 N m/deg`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    field: &'static Field,
    value: f32,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, value } = *self;
        write!(f, "{} = ", field.name)?;
        match field.kind {
            Kind::Choice(names) => f.write_str(names.get(value as usize).copied().unwrap_or("?")),
            Kind::Number { .. } if field.unit.is_empty() => Decimal(value).fmt(f),
            Kind::Number { .. } => write!(f, "{} {}", Decimal(value), field.unit),
        }
    }
}

/// Why a setting is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingError {
    /// No setting has this name.
    Unknown,
    /// The value is not a number within the bounds.
    OutOfRange(&'static Field),
    /// The value is none of the names.
    NotAChoice(&'static Field),
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("no such setting: get lists them all"),
            Self::OutOfRange(field) => match field.kind {
                Kind::Number { min, max } => {
                    write!(
                        f,
                        "{} must be a number from {} to {} {}",
                        field.name,
                        Decimal(min),
                        Decimal(max),
                        field.unit
                    )
                }
                Kind::Choice(_) => f.write_str(field.name),
            },
            Self::NotAChoice(field) => {
                write!(f, "{} must be one of", field.name)?;
                if let Kind::Choice(names) = field.kind {
                    names.iter().try_for_each(|name| write!(f, " {name}"))?;
                }
                Ok(())
            }
        }
    }
}

impl core::error::Error for SettingError {}

impl Settings {
    /// Whether every value is within its bounds.
    ///
    /// # Errors
    /// The first [`SettingError`].
    pub fn check(&self) -> Result<(), SettingError> {
        FIELDS
            .iter()
            .try_for_each(|field| field.check(field.read(self)))
    }

    /// Sets by full or short name.
    ///
    /// # Errors
    /// [`SettingError`], and nothing changes.
    pub fn set(&mut self, name: &str, text: &str) -> Result<&'static Field, SettingError> {
        let field = Field::find(name)?;
        field.write(self, field.parse(text)?)?;
        Ok(field)
    }
}

macro_rules! number {
    ($name:literal $(| $short:literal)?, $unit:literal, $min:literal ..= $max:literal, $($path:ident).+) => {
        Field {
            name: $name,
            short: number!(@short $($short)?),
            unit: $unit,
            kind: Kind::Number { min: $min, max: $max },
            read: |settings| settings.$($path).+,
            write: |settings, value| settings.$($path).+ = value,
        }
    };
    (@short) => { None };
    (@short $short:literal) => { Some($short) };
}

macro_rules! choice {
    ($name:literal, [$($text:literal => $variant:expr),+], $($path:ident).+) => {
        Field {
            name: $name,
            short: None,
            unit: "",
            kind: Kind::Choice(&[$($text),+]),
            read: |settings| {
                [$($variant),+].iter().position(|variant| *variant == settings.$($path).+).unwrap_or(0) as f32
            },
            write: |settings, value| {
                if let Some(variant) = [$($variant),+].get(value as usize) {
                    settings.$($path).+ = *variant;
                }
            },
        }
    };
}

macro_rules! switch {
    ($name:literal, $($path:ident).+) => { choice!($name, ["off" => false, "on" => true], $($path).+) };
}

/// All settings, in the order in which they are shown.
pub static FIELDS: &[Field] = &[
    number!(
        "pid.kp" | "kp",
        "N m/deg at the paddle",
        0.0..=2.0,
        pid.kp_nm_per_deg
    ),
    number!(
        "pid.ki" | "ki",
        "N m/(deg s) at the paddle",
        0.0..=50.0,
        pid.ki_nm_per_deg_s
    ),
    number!(
        "pid.kd" | "kd",
        "N m s/deg at the paddle",
        0.0..=0.1,
        pid.kd_nm_s_per_deg
    ),
    number!("pid.setpoint_weight", "", 0.0..=1.0, pid.setpoint_weight),
    number!(
        "pid.derivative_cutoff",
        "Hz",
        0.0..=10_000.0,
        pid.derivative_cutoff_hz
    ),
    choice!(
        "pid.derivative",
        ["auto" => DerivativeSource::Auto, "position" => DerivativeSource::Position, "observer" => DerivativeSource::Observer],
        pid.derivative
    ),
    choice!("estimate.sensor", ["encoder" => Sensor::Encoder, "hall" => Sensor::Hall], estimate.sensor),
    number!("estimate.cutoff", "Hz", 0.0..=10_000.0, estimate.cutoff_hz),
    choice!("estimate.order", ["first" => FilterOrder::First, "second" => FilterOrder::Second], estimate.order),
    number!(
        "estimate.velocity_bandwidth",
        "Hz",
        1.0..=1_000.0,
        estimate.velocity_bandwidth_hz
    ),
    switch!("compensation.dry", compensation.dry),
    number!(
        "compensation.dry_forward",
        "N m at the motor",
        0.0..=0.01,
        compensation.dry_forward_nm
    ),
    number!(
        "compensation.dry_backward",
        "N m at the motor",
        0.0..=0.01,
        compensation.dry_backward_nm
    ),
    number!(
        "compensation.dry_band",
        "deg/s",
        0.1..=1_000.0,
        compensation.dry_band_deg_s
    ),
    choice!(
        "compensation.dry_source",
        ["measured" => VelocitySource::Measured, "setpoint" => VelocitySource::Setpoint],
        compensation.dry_source
    ),
    switch!("compensation.viscous", compensation.viscous),
    number!(
        "compensation.viscous_level",
        "N m s/rad at the paddle",
        0.0..=0.1,
        compensation.viscous_nm_s_per_rad
    ),
    switch!("compensation.gravity", compensation.gravity),
    number!(
        "compensation.gravity_level",
        "N m at the paddle",
        -1.0..=1.0,
        compensation.gravity_nm
    ),
    number!(
        "compensation.gravity_zero",
        "deg",
        -180.0..=180.0,
        compensation.gravity_zero_deg
    ),
    number!(
        "motor.torque_constant",
        "N m/A",
        0.001..=1.0,
        motor.torque_constant_nm_per_a
    ),
    number!(
        "motor.resistance",
        "ohm",
        0.01..=1_000.0,
        motor.resistance_ohm
    ),
    number!("motor.inductance", "H", 0.000001..=1.0, motor.inductance_h),
    number!("motor.supply", "V", 1.0..=60.0, motor.supply_v),
    number!(
        "motor.bandwidth",
        "Hz",
        1.0..=5_000.0,
        motor.current_bandwidth_hz
    ),
    choice!(
        "motor.current_sampling",
        ["mean" => CurrentSampling::Mean, "centre" => CurrentSampling::Centre],
        motor.current_sampling
    ),
    number!(
        "motor.torque_limit",
        "N m at the motor",
        0.0..=0.0323,
        motor.torque_limit_nm
    ),
    number!("mechanism.ratio", "", 0.1..=1_000.0, mechanism.ratio),
    number!(
        "mechanism.counts_per_turn",
        "",
        4.0..=1_000_000.0,
        mechanism.counts_per_turn
    ),
    number!(
        "mechanism.inertia",
        "kg m2",
        0.000001..=1.0,
        mechanism.inertia_kg_m2
    ),
    number!("hall.centre", "V", 0.0..=5.0, hall.centre_v),
    number!("hall.slope", "deg/V", -200.0..=200.0, hall.slope_deg_per_v),
    number!(
        "hall.quadratic",
        "deg/V2",
        -200.0..=200.0,
        hall.quadratic_deg_per_v2
    ),
    number!(
        "hall.cubic",
        "deg/V3",
        -200.0..=200.0,
        hall.cubic_deg_per_v3
    ),
    // The Hall sensor sees 75 degrees either side.
    number!("limit.travel", "deg", 1.0..=75.0, limit.travel_deg),
    // The motor's speed without load at 24 V is 1700 degrees a second of the paddle.
    number!("limit.speed", "deg/s", 1.0..=2_000.0, limit.speed_deg_s),
    // See `sensing::current::MEASURABLE_A`.
    number!("limit.current", "A", 0.0..=1.55, limit.current_a),
    number!(
        "limit.disagreement",
        "deg",
        0.1..=20.0,
        limit.disagreement_deg
    ),
    number!("limit.stall", "s", 0.0..=60.0, limit.stall_s),
    number!("limit.mismatch", "V", 1.0..=12.0, limit.mismatch_v),
    number!("host.heartbeat", "ms", 0.0..=10_000.0, host.heartbeat_ms),
    number!("metrics.band", "deg", 0.001..=90.0, metrics.band_deg),
];
