//! The actuator, if a recording describes it by a motor's data sheet or as a position servo instead of by `ratio`.

use serde::{Deserialize, Serialize};

use crate::model::{Model, NOT_NEGATIVE, OTHER_THAN_0, POSITIVE};
use crate::units::Units;

/// An actuator that replaces `ratio`. It can also contribute to `viscous` and `stiffness`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuator {
    /// A motor, from the table `[motor]`.
    Motor(Motor),
    /// A position servo, from `servo` in `[model]`.
    Servo(Servo),
}

/// A motor's data sheet, the table `[motor]`.
///
/// The torque of a motor is kt times its current. Its voltage is the resistance times the current plus kt times its speed.
/// An input in A therefore gives the torque gear kt at the joint. An input in V gives gear kt / resistance, minus gear² kt²
/// / resistance times the velocity of the joint. The latter is the contribution of the back-EMF to `viscous`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Torque constant, N m/A. It equals the back-EMF constant in V s/rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kt: Option<f64>,
    /// Resistance of the winding, Ω.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance: Option<f64>,
    /// Motor turns per joint turn, or rad per m for a linear axis. 1 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gear: Option<f64>,
    /// Supply voltage, V, if the input is a duty cycle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<f64>,
}

/// A position servo whose input is a target in units of position: `servo` in `[model]`.
///
/// Its torque at the joint is `stiffness * error - damping * velocity`. The error is `target - position`, with its magnitude
/// reduced by `deadband`; it is 0 within the dead band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// Torque per unit of position error, N m/rad.
    pub stiffness: f64,
    /// Damping, N m s/rad.
    #[serde(default)]
    pub damping: f64,
    /// Largest rate of the internal target, rad/s. `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_limit: Option<f64>,
    /// Half width of the dead band of the position error, rad.
    #[serde(default)]
    pub deadband: f64,
}

/// Why a motor's data sheet gives no ratio. The message names the cause and, after the semicolon, the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRatio {
    /// A number is missing.
    #[error(
        "[motor] lacks `{lacking}`, which is needed to convert an input in {unit} to a torque; add it"
    )]
    Lacks {
        /// Name of the number, one of [`Motor::NAMES`].
        lacking: &'static str,
        /// Unit of the input.
        unit: String,
    },
    /// The unit of the input is not that of a motor.
    #[error(
        "[motor] says nothing of an input in `{unit}`; write \"A\", \"V\", \"duty\" or \"N m\" for `input` of [units], or state `ratio` in place of [motor]"
    )]
    Unit {
        /// Unit of the input.
        unit: String,
    },
}

/// The quantity of a motor's input, with one unit of it in SI units.
#[derive(Clone, Copy)]
enum MotorInput {
    Torque(f64),
    Current(f64),
    Voltage(f64),
    /// A share of the supply voltage.
    Duty(f64),
}

impl MotorInput {
    fn of(unit: &str) -> Option<Self> {
        let bare: String = unit.chars().filter(|c| !" *·.".contains(*c)).collect();
        Some(match bare.as_str() {
            "Nm" | "N" => Self::Torque(1.0),
            "mNm" | "mN" => Self::Torque(1e-3),
            "A" => Self::Current(1.0),
            "mA" => Self::Current(1e-3),
            "V" => Self::Voltage(1.0),
            "mV" => Self::Voltage(1e-3),
            "duty" => Self::Duty(1.0),
            "%" | "percent" => Self::Duty(0.01),
            _ => return None,
        })
    }
}

impl Motor {
    /// Every key of the table.
    pub const NAMES: [&str; 4] = ["kt", "resistance", "gear", "supply"];

    /// The number called `name`. `None` if it is not stated or does not exist.
    pub fn get(&self, name: &str) -> Option<f64> {
        match name {
            "kt" => self.kt,
            "resistance" => self.resistance,
            "gear" => self.gear,
            "supply" => self.supply,
            _ => None,
        }
    }

    /// Sets the number called `name`. Returns false if there is no such number.
    #[must_use]
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        let place = match name {
            "kt" => &mut self.kt,
            "resistance" => &mut self.resistance,
            "gear" => &mut self.gear,
            "supply" => &mut self.supply,
            _ => return false,
        };
        *place = Some(value);
        true
    }

    /// Torque at the joint per unit of the input.
    ///
    /// # Errors
    /// [`NoRatio`].
    pub fn ratio(&self, units: &Units) -> Result<f64, NoRatio> {
        let needed = |name| self.needed(name, units);
        let gear = self.gear.unwrap_or(1.0);
        Ok(match motor_input(units)? {
            MotorInput::Torque(si) => si * gear,
            MotorInput::Current(si) => si * gear * needed("kt")?,
            MotorInput::Voltage(si) => si * gear * needed("kt")? / needed("resistance")?,
            MotorInput::Duty(si) => {
                si * gear * needed("kt")? * needed("supply")? / needed("resistance")?
            }
        })
    }

    /// Viscous friction at the joint that the back-EMF causes. 0 if the input is a torque or a current.
    ///
    /// # Errors
    ///
    /// [`NoRatio`].
    pub fn back_emf(&self, units: &Units) -> Result<f64, NoRatio> {
        match motor_input(units)? {
            MotorInput::Torque(_) | MotorInput::Current(_) => Ok(0.0),
            MotorInput::Voltage(_) | MotorInput::Duty(_) => {
                let constant = self.gear.unwrap_or(1.0) * self.needed("kt", units)?;
                let resistance = self.needed("resistance", units)?;
                Ok(units.angle_rad() * constant * constant / resistance)
            }
        }
    }

    fn needed(&self, lacking: &'static str, units: &Units) -> Result<f64, NoRatio> {
        let unit = || units.input.trim().to_owned();
        self.get(lacking).ok_or_else(|| NoRatio::Lacks {
            lacking,
            unit: unit(),
        })
    }
}

fn motor_input(units: &Units) -> Result<MotorInput, NoRatio> {
    MotorInput::of(&units.input).ok_or_else(|| NoRatio::Unit {
        unit: units.input.clone(),
    })
}

impl Actuator {
    /// Names of the model's numbers that this actuator defines.
    pub(crate) fn stands_for(&self) -> &'static [&'static str] {
        match self {
            Self::Motor(_) => &["ratio"],
            Self::Servo(_) => &["ratio", "stiffness", "input_rate_limit", "error_deadband"],
        }
    }

    /// Name of its table.
    pub(crate) fn table(&self) -> &'static str {
        match self {
            Self::Motor(_) => "[motor]",
            Self::Servo(_) => "`servo`",
        }
    }

    /// The model of `joint` together with this actuator.
    ///
    /// # Errors
    ///
    /// [`NoRatio`] if the data sheet does not define the effect of the input.
    pub(crate) fn added_to(&self, joint: &Model, units: &Units) -> Result<Model, NoRatio> {
        let viscous = joint.viscous + self.viscous(units)?;
        Ok(match self {
            Self::Motor(motor) => Model {
                ratio: motor.ratio(units)?,
                viscous,
                ..*joint
            },
            Self::Servo(servo) => Model {
                ratio: servo.stiffness,
                stiffness: servo.stiffness,
                input_rate_limit: servo.speed_limit,
                error_deadband: (servo.deadband > 0.0).then_some(servo.deadband),
                viscous,
                ..*joint
            },
        })
    }

    /// The joint without this actuator. `None` if the model no longer contains this actuator.
    pub(crate) fn taken_from(&self, model: &Model, units: &Units) -> Option<Model> {
        let viscous = model.viscous - self.viscous(units).ok()?;
        let joint = Model { viscous, ..*model };
        let again = self.added_to(&joint, units).ok()?;
        let is_same = again.ratio == model.ratio
            && again.stiffness == model.stiffness
            && again.input_rate_limit == model.input_rate_limit
            && again.error_deadband == model.error_deadband;
        is_same.then_some(joint)
    }

    /// Its contribution to the viscous friction.
    ///
    /// # Errors
    ///
    /// The same as for [`added_to`](Self::added_to).
    pub(crate) fn viscous(&self, units: &Units) -> Result<f64, NoRatio> {
        match self {
            Self::Motor(motor) => motor.back_emf(units),
            Self::Servo(servo) => Ok(servo.damping),
        }
    }

    /// Its numbers: path in the manifest, value, whether the value is allowed, and the allowed values in words.
    pub(crate) fn judged(&self) -> Vec<(String, f64, bool, &'static str)> {
        let at = |table: &'static str| move |name: &str| format!("{table}.{name}");
        match self {
            Self::Motor(motor) => {
                let key = at("motor");
                let stated = Motor::NAMES.into_iter();
                let stated = stated.filter_map(|name| Some((name, motor.get(name)?)));
                let judged = stated.map(|(name, value)| match name {
                    "gear" => (key(name), value, value != 0.0, OTHER_THAN_0),
                    _ => (key(name), value, value > 0.0, POSITIVE),
                });
                judged.collect()
            }
            Self::Servo(servo) => {
                let key = at("model.servo");
                let least = |name, value: f64| (key(name), value, value >= 0.0, NOT_NEGATIVE);
                let above = |name, value: f64| (key(name), value, value > 0.0, POSITIVE);
                let mut judged = vec![
                    above("stiffness", servo.stiffness),
                    least("damping", servo.damping),
                    least("deadband", servo.deadband),
                ];
                judged.extend(servo.speed_limit.map(|limit| above("speed_limit", limit)));
                judged
            }
        }
    }
}
