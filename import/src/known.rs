//! What the user knows about a device.

use crate::error::ImportError;
use recording::{Model, Motor, Units};
use std::collections::BTreeMap;

/// Acceleration of gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

/// The kind of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// A rotary axis without further information.
    #[default]
    Rotary,
    /// A rotary axis with gravity.
    Pendulum,
    /// A linear axis.
    Linear,
    /// A position servo.
    Servo,
}

/// Known properties of a device. Unknown numbers are estimated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// The kind of the device.
    pub kind: Kind,
    /// Moving mass, kg.
    pub mass_kg: Option<f64>,
    /// Distance of its centre from the axis, m.
    pub lever_m: Option<f64>,
    /// The motor's data sheet and its gear.
    pub motor: Motor,
    /// Inertia of the motor's rotor, kg m².
    pub rotor_inertia: Option<f64>,
    /// Stated numbers of `[model]`.
    pub numbers: BTreeMap<String, f64>,
    /// Relative standard deviations of the stated numbers.
    pub tolerances: BTreeMap<String, f64>,
}

/// A number of `[model]` and its source.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Number {
    pub value: f64,
    pub why: String,
}

impl Known {
    /// The warning that no model is stated because the inertia is unknown. `None` if the inertia is known.
    pub fn unstated_warning(&self) -> Option<String> {
        let numbers = self.numbers("").unwrap_or_default();
        (!numbers.contains_key("inertia")).then(|| {
            "the model's inertia is not stated, so the gap will be that of a model which is estimated from this log, not that of your simulation; state what it uses by --model, or in recording.toml".into()
        })
    }

    /// The motor's data sheet, if it states more than a gear, with the joint torque per unit of input.
    ///
    /// # Errors
    ///
    /// [`ImportError::Motor`] if the data sheet is incomplete, [`ImportError::Option`] if the ratio is stated too.
    pub(crate) fn data_sheet(&self, units: &Units) -> Result<Option<(Motor, f64)>, ImportError> {
        if self.motor.kt.is_none() {
            return Ok(None);
        }
        if self.numbers.contains_key("ratio") {
            return Err(ImportError::Option(
                "--motor and --model ratio both say what a unit of input gives; leave one out"
                    .into(),
            ));
        }
        Ok(Some((self.motor, self.motor.ratio(units)?)))
    }

    /// The numbers of `[model]` that follow for an input in `unit`, except those that follow from a motor's data sheet.
    ///
    /// # Errors
    ///
    /// [`ImportError::Option`] for unknown names.
    pub(crate) fn numbers(
        &self,
        unit: &str,
    ) -> Result<BTreeMap<&'static str, Number>, ImportError> {
        let mut numbers = BTreeMap::new();
        let mut put = |name, value, why: String| {
            numbers.insert(name, Number { value, why });
        };
        if let (Some(gear), None, "N m" | "N") = (self.motor.gear, self.motor.kt, unit) {
            put(
                "ratio",
                gear,
                format!("gear {gear}; the input is at the motor"),
            );
        }
        if self.kind == Kind::Servo {
            put(
                "ratio",
                1.0,
                "torque is counted in units of the servo's own stiffness".into(),
            );
            put(
                "stiffness",
                1.0,
                "likewise: it pulls towards the position that it is told".into(),
            );
        }
        match (self.kind, self.mass_kg, self.lever_m) {
            (Kind::Linear, Some(mass), _) => put("inertia", mass, "the mass that moves".into()),
            (Kind::Rotary | Kind::Pendulum, Some(mass), Some(lever)) => {
                let gear = self.motor.gear.unwrap_or(1.0);
                let rotor = self.rotor_inertia.map_or(0.0, |rotor| gear * gear * rotor);
                let why = if rotor > 0.0 {
                    "mass times lever², and gear² times the rotor's"
                } else {
                    "mass times lever², as if all were at its end"
                };
                put("inertia", mass * lever * lever + rotor, why.into());
                if self.kind == Kind::Pendulum {
                    put(
                        "gravity",
                        mass * GRAVITY_M_S2 * lever,
                        "mass times 9.81 m/s² times lever".into(),
                    );
                }
            }
            _ => {}
        }
        for (name, value) in &self.numbers {
            let known = Model::NAMES
                .into_iter()
                .find(|known| known == name && *known != "travel");
            let known = known.ok_or_else(|| {
                ImportError::Option(format!(
                    "[model] has no number `{name}`; there are {}",
                    Model::NAMES.join(", ")
                ))
            })?;
            put(known, *value, "as stated".into());
        }
        if let Some(name) = self
            .tolerances
            .keys()
            .find(|name| !Model::NAMES.contains(&name.as_str()))
        {
            return Err(ImportError::Option(format!(
                "[model] has no number `{name}`; there are {}",
                Model::NAMES.join(", ")
            )));
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_data_sheet_gives_the_ratio_of_the_inputs_unit() {
        let motor = Motor {
            kt: Some(0.0538),
            resistance: Some(10.6),
            gear: Some(15.0),
            ..Motor::default()
        };
        let known = Known {
            motor,
            ..Known::default()
        };
        let ratio = |unit: &str| {
            let units = Units {
                input: unit.into(),
                ..Units::default()
            };
            let sheet = known.data_sheet(&units);
            sheet.map(|sheet| sheet.expect("a data sheet").1)
        };
        assert_eq!(ratio("A").ok(), Some(15.0 * 0.0538));
        assert_eq!(ratio("V").ok(), Some(15.0 * 0.0538 / 10.6));
        let lacking = ratio("duty").expect_err("no supply").to_string();
        assert!(lacking.contains("lacks `supply`"), "{lacking}");
    }
}
