//! The nominal model and the tolerances of its numbers.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The table `[model]`: a single axis in SI units, rotary (rad, N m) or linear (m, N).
///
/// The joint torque is `ratio * input - viscous * v - gravity * sin(angle_rad * (x - gravity_zero)) - stiffness * (x -
/// stiffness_zero) + offset`, minus dry friction and the torque of the stops. The acceleration is this torque over
/// `inertia`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Inertia at the joint including the motor's rotor, kg m² (kg).
    pub inertia: f64,
    /// Viscous friction, N m s/rad.
    #[serde(default)]
    pub viscous: f64,
    /// Level of the dry friction at the joint, equal at rest and while sliding, N m.
    #[serde(default)]
    pub coulomb: f64,
    /// Amplitude of the gravity torque, N m. With a positive value the joint hangs at `gravity_zero`.
    #[serde(default)]
    pub gravity: f64,
    /// Position at which gravity has no torque, rad.
    #[serde(default)]
    pub gravity_zero: f64,
    /// Stiffness of the spring, N m/rad.
    #[serde(default)]
    pub stiffness: f64,
    /// Position at which the spring has no torque, rad.
    #[serde(default)]
    pub stiffness_zero: f64,
    /// Constant torque at the joint, N m.
    #[serde(default)]
    pub offset: f64,
    /// Joint torque per unit of input. 1 if left out.
    #[serde(default = "one")]
    pub ratio: f64,
    /// Dead time from input to torque, s. If it is negative, the input of a row acted before the time of the row.
    #[serde(default)]
    pub delay: f64,
    /// Time constant of the first-order lag from input to torque, s.
    #[serde(default)]
    pub lag: f64,
    /// Largest magnitude of the input, before delay and lag. `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_limit: Option<f64>,
    /// Largest rate of the acting input, per s, before delay and lag. `None` is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_rate_limit: Option<f64>,
    /// Half width of the dead band of a position servo, rad. `None` is no dead band. The servo has no torque if the magnitude of
    /// `input - position` is smaller. Otherwise the magnitude of its torque is smaller by `ratio * error_deadband`. The model
    /// of a servo has `stiffness` equal to `ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_deadband: Option<f64>,
    /// Positions of the lower and the upper hard stop, rad. `None` is no stops.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel: Option<[f64; 2]>,
    /// Stiffness of the stops, N m/rad. 20 if left out.
    #[serde(default = "default_stop_stiffness")]
    pub stop_stiffness: f64,
    /// Damping of the stops in contact, N m s/rad. 0.02 if left out.
    #[serde(default = "default_stop_damping")]
    pub stop_damping: f64,
    /// Angle of one unit of position, rad: 1, or less for a recording in degrees. The units of the recording define it, not
    /// this table.
    #[serde(skip, default = "one")]
    pub angle_rad: f64,
}

/// A number of a model is outside its possible range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{name}` is {value}; it must be {wanted}")]
pub struct NoModel {
    /// Name of the number, one of [`Model::NAMES`].
    pub name: &'static str,
    /// Value of the number as text.
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
    /// Every key of the table. `travel` is a pair, the input limits and `error_deadband` may be absent, and all others are
    /// numbers.
    pub const NAMES: [&str; 17] = [
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
        "error_deadband",
        "travel",
        "stop_stiffness",
        "stop_damping",
    ];

    /// Numbers that every axis needs. If a recording does not state one, it is unknown and is estimated. All other numbers
    /// describe optional parts, which are absent if not stated.
    pub const ESSENTIAL: [&str; 4] = ["ratio", "viscous", "coulomb", "gravity"];

    /// A free, frictionless inertia (kg m²) whose input is a torque.
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
            error_deadband: None,
            travel: None,
            stop_stiffness: default_stop_stiffness(),
            stop_damping: default_stop_damping(),
            angle_rad: one(),
        }
    }

    /// Checks that every number is within its possible range.
    ///
    /// # Errors
    ///
    /// [`NoModel`] for the first number that is not.
    pub fn check(&self) -> Result<(), NoModel> {
        for name in Self::NAMES {
            let Some(value) = self.get(name) else {
                continue;
            };
            let (holds, wanted) = match name {
                "inertia" | "input_limit" | "input_rate_limit" => (value > 0.0, POSITIVE),
                "ratio" => (value != 0.0, OTHER_THAN_0),
                "coulomb" | "lag" | "error_deadband" | "stop_stiffness" | "stop_damping" => {
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

    /// The number called `name`. `None` for an absent limit or dead band, for the pair `travel` and for unknown names.
    pub fn get(&self, name: &str) -> Option<f64> {
        let mut copy = *self;
        copy.number_mut(name).map(|number| *number)
    }

    /// Sets the number called `name`. Returns `false`, and changes nothing, where [`get`](Self::get) returns `None`.
    #[must_use]
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        self.number_mut(name)
            .map(|number| *number = value)
            .is_some()
    }

    /// Sets a number like [`set`](Self::set), and also a limit or a dead band that was absent.
    #[must_use]
    pub fn state(&mut self, name: &str, value: f64) -> bool {
        match name {
            "input_limit" => self.input_limit = Some(value),
            "input_rate_limit" => self.input_rate_limit = Some(value),
            "error_deadband" => self.error_deadband = Some(value),
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
            "error_deadband" => return self.error_deadband.as_mut(),
            "stop_stiffness" => &mut self.stop_stiffness,
            "stop_damping" => &mut self.stop_damping,
            _ => return None,
        })
    }
}

/// Relative standard deviations of the model's numbers by name. A number without one is known exactly.
///
/// The value of `travel` applies to both ends.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Tolerance(BTreeMap<String, f64>);

impl Tolerance {
    /// The relative standard deviation of the number called `name`. 0 if none is stated.
    pub fn of(&self, name: &str) -> f64 {
        self.0.get(name).copied().unwrap_or(0.0)
    }

    /// States the standard deviation `relative` (1 = 100 %) of the number called `name`, one of [`Model::NAMES`].
    pub fn set(&mut self, name: impl Into<String>, relative: f64) {
        self.0.insert(name.into(), relative);
    }

    /// The stated names and their relative standard deviations, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0
            .iter()
            .map(|(name, &relative)| (name.as_str(), relative))
    }

    /// True if nothing is stated.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_except_the_pair_sets_its_own_field() {
        let mut model = Model {
            input_limit: Some(0.0),
            input_rate_limit: Some(0.0),
            error_deadband: Some(0.0),
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
