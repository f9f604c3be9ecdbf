//! Options that state the known data of a device.

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use import::{ImportError, Kind, Known};
use recording::Motor;

/// Name that `--motor` accepts in addition to the keys of `[motor]`.
const ROTOR_INERTIA: &str = "rotor_inertia";

/// Known data of a device. Values that are not given are estimated.
#[derive(Args, Default)]
pub struct KnownArguments {
    /// Kind of device.
    #[arg(long, value_enum)]
    pub kind: Option<DeviceKind>,
    /// Gear ratio: turns of the motor per turn of the joint.
    #[arg(long, value_name = "RATIO")]
    gear: Option<f64>,
    /// Moving mass, kg.
    #[arg(long, value_name = "KG")]
    mass: Option<f64>,
    /// Distance from the axis to the centre of the moving mass, m.
    #[arg(long, value_name = "M")]
    lever: Option<f64>,
    /// Motor data sheet: kt in N m/A, resistance in Ohm, gear, and supply in V, which become [motor]; rotor_inertia in kg
    /// m2; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = number, value_delimiter = ',')]
    motor: Vec<(String, f64)>,
    /// Value of a number of [model], such as inertia=5.8e-4; may be repeated.
    #[arg(long = "model", value_name = "NAME=VALUE", value_parser = number, value_delimiter = ',')]
    numbers: Vec<(String, f64)>,
    /// Relative standard deviation of a number of [model], such as inertia=0.02; may be repeated.
    #[arg(long, value_name = "NAME=SHARE", value_parser = number, value_delimiter = ',')]
    tolerance: Vec<(String, f64)>,
}

/// Kind of device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DeviceKind {
    /// A rotating device.
    Rotary,
    /// A rotating device with gravity: its weight pulls it towards the hanging position.
    Pendulum,
    /// A device that moves linearly.
    Linear,
    /// A position servo, whose input is the commanded position.
    Servo,
}

impl KnownArguments {
    /// Converts the options to the known data.
    ///
    /// # Errors
    /// Returns [`ImportError::Option`] for a name that is not a motor parameter.
    pub fn known(&self) -> Result<Known, Failure> {
        let mut motor = Motor::default();
        let mut rotor_inertia = None;
        for (name, value) in &self.motor {
            if name == ROTOR_INERTIA {
                rotor_inertia = Some(*value);
            } else if !motor.set(name, *value) {
                let known = Motor::NAMES.join(", ");
                return Err(ImportError::Option(format!(
                    "--motor has no `{name}`; there are {known}, {ROTOR_INERTIA}"
                ))
                .into());
            }
        }
        motor.gear = self.gear.or(motor.gear);
        Ok(Known {
            kind: match self.kind {
                None | Some(DeviceKind::Rotary) => Kind::Rotary,
                Some(DeviceKind::Pendulum) => Kind::Pendulum,
                Some(DeviceKind::Linear) => Kind::Linear,
                Some(DeviceKind::Servo) => Kind::Servo,
            },
            mass_kg: self.mass,
            lever_m: self.lever,
            motor,
            rotor_inertia,
            numbers: self.numbers.iter().cloned().collect(),
            tolerances: self.tolerance.iter().cloned().collect(),
        })
    }

    /// Whether no option is given.
    pub fn is_empty(&self) -> bool {
        self.kind.is_none()
            && [self.gear, self.mass, self.lever]
                .iter()
                .all(Option::is_none)
            && self.motor.is_empty()
            && self.numbers.is_empty()
    }
}

/// Parses `NAME=TEXT`.
pub fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE".into()),
    }
}

/// Parses `NAME=NUMBER`.
fn number(text: &str) -> Result<(String, f64), String> {
    let (name, value) = pair(text)?;
    let value: f64 = value
        .parse()
        .map_err(|_| format!("`{value}` is no number"))?;
    if value.is_finite() {
        Ok((name, value))
    } else {
        Err(format!("`{value}` is no finite number"))
    }
}
