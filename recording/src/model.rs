//! The nominal model and how well its numbers are known.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The `[model]` table: a single axis in SI units, rotary (rad, N m) or linear (m, N).
///
/// Joint torque is `ratio * input - viscous * v - gravity * sin(angle_rad * (x - gravity_zero))
/// - stiffness * (x - stiffness_zero) + offset`, less dry friction and the stops; acceleration is that over `inertia`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Inertia at the joint, motor rotor included, kg m² (kg).
    pub inertia: f64,
    /// Viscous friction, N m s/rad.
    #[serde(default)]
    pub viscous: f64,
    /// Dry friction level at the joint, the same for stick and slip, N m.
    #[serde(default)]
    pub coulomb: f64,
    /// Amplitude of the gravity torque, N m; positive hangs at `gravity_zero`.
    #[serde(default)]
    pub gravity: f64,
    /// Position at which gravity has no torque, rad.
    #[serde(default)]
    pub gravity_zero: f64,
    /// Spring rate, N m/rad.
    #[serde(default)]
    pub stiffness: f64,
    /// Position at which the spring has no torque, rad.
    #[serde(default)]
    pub stiffness_zero: f64,
    /// Constant torque at the joint, N m.
    #[serde(default)]
    pub offset: f64,
    /// Joint torque per unit of input; 1 if left out.
    #[serde(default = "one")]
    pub ratio: f64,
    /// Pure delay from input to torque, s. Below zero, each row's input acted before the time of the row.
    #[serde(default)]
    pub delay: f64,
    /// Time constant of the first-order lag from input to torque, s.
    #[serde(default)]
    pub lag: f64,
    /// The input is clipped to ± this, before delay and lag; `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_limit: Option<f64>,
    /// What acts of the input changes no faster, per s, before delay and lag; `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_rate_limit: Option<f64>,
    /// Positions of the lower and the upper hard stop, rad; `None` is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel: Option<[f64; 2]>,
    /// Spring rate of the stops, N m/rad; 20 if left out.
    #[serde(default = "default_stop_stiffness")]
    pub stop_stiffness: f64,
    /// Damping of the stops while in contact, N m s/rad; 0.02 if left out.
    #[serde(default = "default_stop_damping")]
    pub stop_damping: f64,
    /// Angle of one unit of position, rad: 1, or less for a recording in degrees. It is no number of the table, its recording's
    /// units say it.
    #[serde(skip, default = "one")]
    pub angle_rad: f64,
}

/// A number of a model that is outside its possible range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{name}` is {value}; it must be {wanted}")]
pub struct NoModel {
    /// Its name, one of [`Model::NAMES`].
    pub name: &'static str,
    /// Its value, as text.
    pub value: String,
    /// The possible values, in words.
    pub wanted: &'static str,
}

pub(crate) const FINITE: &str = "a finite number";
pub(crate) const POSITIVE: &str = "above 0";
pub(crate) const NOT_NEGATIVE: &str = "0 or above";
pub(crate) const OTHER_THAN_0: &str = "other than 0";

fn one() -> f64 {
    1.0
}

fn default_stop_stiffness() -> f64 {
    20.0
}

fn default_stop_damping() -> f64 {
    0.02
}

impl Model {
    /// Every key of the table. `travel` is a pair, the limits of the input may be absent, the others are plain numbers.
    pub const NAMES: [&str; 16] = [
        "inertia",
        "viscous",
        "coulomb",
        "gravity",
        "gravity_zero",
        "stiffness",
        "stiffness_zero",
        "offset",
        "ratio",
        "delay",
        "lag",
        "input_limit",
        "input_rate_limit",
        "travel",
        "stop_stiffness",
        "stop_damping",
    ];

    /// Numbers without which no axis is described: one that a recording does not state is not known, and is estimated. The
    /// other numbers describe parts that an axis need not have; one that is not stated is taken as absent.
    pub const ESSENTIAL: [&str; 4] = ["ratio", "viscous", "coulomb", "gravity"];

    /// A free, frictionless `inertia` (kg m²) driven by its input as torque.
    pub fn new(inertia: f64) -> Self {
        Self {
            inertia,
            viscous: 0.0,
            coulomb: 0.0,
            gravity: 0.0,
            gravity_zero: 0.0,
            stiffness: 0.0,
            stiffness_zero: 0.0,
            offset: 0.0,
            ratio: one(),
            delay: 0.0,
            lag: 0.0,
            input_limit: None,
            input_rate_limit: None,
            travel: None,
            stop_stiffness: default_stop_stiffness(),
            stop_damping: default_stop_damping(),
            angle_rad: one(),
        }
    }

    /// Checks that every number is within its possible range.
    ///
    /// # Errors
    /// [`NoModel`], the first of them.
    pub fn check(&self) -> Result<(), NoModel> {
        for name in Self::NAMES {
            let Some(value) = self.get(name) else {
                continue;
            };
            let (holds, wanted) = match name {
                "inertia" | "input_limit" | "input_rate_limit" => (value > 0.0, POSITIVE),
                "ratio" => (value != 0.0, OTHER_THAN_0),
                "coulomb" | "lag" | "stop_stiffness" | "stop_damping" => {
                    (value >= 0.0, NOT_NEGATIVE)
                }
                _ => (true, FINITE),
            };
            if !holds || !value.is_finite() {
                return Err(NoModel {
                    name,
                    value: value.to_string(),
                    wanted: if value.is_finite() { wanted } else { FINITE },
                });
            }
        }
        match self.travel {
            Some(travel @ [low, high]) if low >= high || !(high - low).is_finite() => {
                Err(NoModel {
                    name: "travel",
                    value: format!("{travel:?}"),
                    wanted: "[lower, upper], the lower one first",
                })
            }
            _ => Ok(()),
        }
    }

    /// The model with the opposite sign of `ratio`.
    #[must_use]
    pub fn turned(self) -> Self {
        Self {
            ratio: -self.ratio,
            ..self
        }
    }

    /// The model with the opposite sign of positions and torques, and the same sign of the input.
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self {
            gravity_zero: -self.gravity_zero,
            stiffness_zero: -self.stiffness_zero,
            offset: -self.offset,
            travel: self.travel.map(|[lower, upper]| [-upper, -lower]),
            ..self.turned()
        }
    }

    /// The number called `name`; `None` for an absent limit, for the pair `travel` and for names that do not exist.
    pub fn get(&self, name: &str) -> Option<f64> {
        let mut copy = *self;
        copy.number_mut(name).map(|number| *number)
    }

    /// Sets the number called `name`; `false` where [`get`](Self::get) has nothing to give, and then nothing changes.
    #[must_use]
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        self.number_mut(name)
            .map(|number| *number = value)
            .is_some()
    }

    /// Sets a number as [`set`](Self::set) does, including limits of the input that were absent before.
    #[must_use]
    pub fn state(&mut self, name: &str, value: f64) -> bool {
        match name {
            "input_limit" => self.input_limit = Some(value),
            "input_rate_limit" => self.input_rate_limit = Some(value),
            name => return self.set(name, value),
        }
        true
    }

    fn number_mut(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "inertia" => &mut self.inertia,
            "viscous" => &mut self.viscous,
            "coulomb" => &mut self.coulomb,
            "gravity" => &mut self.gravity,
            "gravity_zero" => &mut self.gravity_zero,
            "stiffness" => &mut self.stiffness,
            "stiffness_zero" => &mut self.stiffness_zero,
            "offset" => &mut self.offset,
            "ratio" => &mut self.ratio,
            "delay" => &mut self.delay,
            "lag" => &mut self.lag,
            "input_limit" => return self.input_limit.as_mut(),
            "input_rate_limit" => return self.input_rate_limit.as_mut(),
            "stop_stiffness" => &mut self.stop_stiffness,
            "stop_damping" => &mut self.stop_damping,
            _ => return None,
        })
    }
}

/// Relative standard deviation of the model's numbers, by name; what is left out is known exactly.
///
/// The one of `travel` holds for both of its ends.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Tolerance(BTreeMap<String, f64>);

impl Tolerance {
    /// The relative standard deviation of the number called `name`; 0 if nothing is stated.
    pub fn of(&self, name: &str) -> f64 {
        self.0.get(name).copied().unwrap_or(0.0)
    }

    /// States `relative` (1 = 100 %) for the number called `name`, one of [`Model::NAMES`].
    pub fn set(&mut self, name: impl Into<String>, relative: f64) {
        self.0.insert(name.into(), relative);
    }

    /// The stated names and their relative standard deviations, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0
            .iter()
            .map(|(name, &relative)| (name.as_str(), relative))
    }

    /// Whether nothing is stated.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_but_the_pair_reaches_a_field_of_its_own() {
        let mut model = Model {
            input_limit: Some(0.0),
            input_rate_limit: Some(0.0),
            ..Model::new(0.0)
        };
        let scalars: Vec<_> = Model::NAMES
            .into_iter()
            .filter(|name| *name != "travel")
            .collect();
        for (k, name) in (1_i32..).zip(&scalars) {
            assert!(model.set(name, f64::from(k)), "{name}");
        }
        for (k, name) in (1_i32..).zip(&scalars) {
            assert_eq!(model.get(name), Some(f64::from(k)), "{name}");
        }
    }

    #[test]
    fn an_absent_limit_and_an_unknown_name_have_no_number() {
        let mut model = Model::new(1.0);
        assert_eq!(model.get("input_limit"), None);
        assert!(!model.set("inertai", 2.0));
        assert_eq!(model, Model::new(1.0));
    }
}
