//! What drives the joint, where a recording says so in place of `ratio`: a motor's data sheet, or a position servo.

use serde::{Deserialize, Serialize};

use crate::model::{Model, NOT_NEGATIVE, OTHER_THAN_0, POSITIVE};
use crate::units::Units;

/// Numbers that stand for `ratio`, and for what the drive adds to `viscous` and `stiffness`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuator {
    /// `[motor]`.
    Motor(Motor),
    /// `servo` of `[model]`.
    Servo(Servo),
}

/// A motor's data sheet, the table `[motor]`.
///
/// A motor's torque is kt times its current, and its voltage the resistance times the current and kt times its speed. So an
/// input in A gives the torque gear kt at the joint, one in V gear kt / resistance, less gear² kt² / resistance times the
/// joint's velocity, which is the share of `viscous` that the back-EMF has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Torque constant, N m/A, which is the speed constant in V s/rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kt: Option<f64>,
    /// Resistance of the winding, Ω.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance: Option<f64>,
    /// Turns of the motor per turn of the joint, of a linear axis rad per m; 1 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gear: Option<f64>,
    /// Voltage of the supply, V, where the input is a duty cycle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<f64>,
}

/// A position servo, whose input is a target in units of position: `servo` of `[model]`.
///
/// Its torque at the joint is `stiffness * (target - position) - damping * velocity`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// Torque per unit of position error, N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    #[serde(default)]
    pub damping: f64,
    /// The target moves no faster, rad/s; `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_limit: Option<f64>,
    /// Position error up to which the servo does nothing, rad.
    #[serde(default)]
    pub deadband: f64,
}

impl Servo {
    /// True if it has a dead band, which no number of the model says.
    pub fn is_beyond_model(&self) -> bool {
        self.deadband > 0.0
    }
}

/// What a motor's data sheet does not tell: the cause and, after the semicolon, the mend.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRatio {
    /// A number is missing.
    #[error("[motor] lacks `{lacking}`, without which an input in {unit} gives no torque; add it")]
    Lacks {
        /// One of [`Motor::NAMES`].
        lacking: &'static str,
        /// Unit of the input.
        unit: String,
    },
    /// The unit of the input is none of a motor.
    #[error(
        "[motor] says nothing of an input in `{unit}`; write \"A\", \"V\", \"duty\" or \"N m\" for `input` of [units], or state `ratio` in place of [motor]"
    )]
    Unit {
        /// Unit of the input.
        unit: String,
    },
}

/// What an input is to a motor, with one of its unit in SI.
#[derive(Clone, Copy)]
enum Told {
    Torque(f64),
    Current(f64),
    Voltage(f64),
    /// Share of the supply's voltage.
    Duty(f64),
}

impl Told {
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

    /// The number called `name`; `None` for one that is not stated or not there.
    pub fn get(&self, name: &str) -> Option<f64> {
        match name {
            "kt" => self.kt,
            "resistance" => self.resistance,
            "gear" => self.gear,
            "supply" => self.supply,
            _ => None,
        }
    }

    /// Sets the number called `name`; false if none is called so.
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
        Ok(match told(units)? {
            Told::Torque(si) => si * gear,
            Told::Current(si) => si * gear * needed("kt")?,
            Told::Voltage(si) => si * gear * needed("kt")? / needed("resistance")?,
            Told::Duty(si) => si * gear * needed("kt")? * needed("supply")? / needed("resistance")?,
        })
    }

    /// Viscous friction at the joint that the back-EMF makes; 0 where the current is the input.
    ///
    /// # Errors
    /// [`NoRatio`].
    pub fn back_emf(&self, units: &Units) -> Result<f64, NoRatio> {
        match told(units)? {
            Told::Torque(_) | Told::Current(_) => Ok(0.0),
            Told::Voltage(_) | Told::Duty(_) => {
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

fn told(units: &Units) -> Result<Told, NoRatio> {
    Told::of(&units.input).ok_or_else(|| NoRatio::Unit {
        unit: units.input.clone(),
    })
}

impl Actuator {
    /// The numbers of the model that this actuator gives.
    pub(crate) fn stands_for(&self) -> &'static [&'static str] {
        match self {
            Self::Motor(_) => &["ratio"],
            Self::Servo(_) => &["ratio", "stiffness", "input_rate_limit"],
        }
    }

    /// Its table.
    pub(crate) fn table(&self) -> &'static str {
        match self {
            Self::Motor(_) => "[motor]",
            Self::Servo(_) => "`servo`",
        }
    }

    /// Adds it to a model that states the joint alone.
    ///
    /// # Errors
    /// [`NoRatio`] of a motor whose data sheet does not tell what the input does.
    pub(crate) fn added_to(&self, joint: &Model, units: &Units) -> Result<Model, NoRatio> {
        let (ratio, stiffness, input_rate_limit) = match self {
            Self::Motor(motor) => (motor.ratio(units)?, joint.stiffness, joint.input_rate_limit),
            Self::Servo(servo) => (servo.stiffness, servo.stiffness, servo.speed_limit),
        };
        let viscous = joint.viscous + self.viscous(units)?;
        Ok(Model {
            ratio,
            stiffness,
            input_rate_limit,
            viscous,
            ..*joint
        })
    }

    /// What the joint has of a model with this drive; `None` if that is not the model's drive any more.
    pub(crate) fn taken_from(&self, model: &Model, units: &Units) -> Option<Model> {
        let viscous = model.viscous - self.viscous(units).ok()?;
        let joint = Model { viscous, ..*model };
        let again = self.added_to(&joint, units).ok()?;
        let is_same = again.ratio == model.ratio
            && again.stiffness == model.stiffness
            && again.input_rate_limit == model.input_rate_limit;
        is_same.then_some(joint)
    }

    /// What it adds to the viscous friction.
    ///
    /// # Errors
    /// As [`added_to`](Self::added_to).
    pub(crate) fn viscous(&self, units: &Units) -> Result<f64, NoRatio> {
        match self {
            Self::Motor(motor) => motor.back_emf(units),
            Self::Servo(servo) => Ok(servo.damping),
        }
    }

    /// Its numbers by their paths in the manifest, whether a drive may have them, and what it must have instead.
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
