//! What the user knows of a device.

use crate::error::ImportError;
use recording::Model;
use std::collections::BTreeMap;

/// Acceleration of gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

/// What moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// It turns, and nobody says more.
    #[default]
    Rotary,
    /// It turns, and weight pulls it towards hanging.
    Pendulum,
    /// It slides.
    Linear,
    /// It follows a position that it is told.
    Servo,
}

/// What is known of a device; what is left out is estimated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// What moves.
    pub kind: Kind,
    /// Turns of the motor per turn of the joint.
    pub gear: Option<f64>,
    /// Mass that moves, kg.
    pub mass_kg: Option<f64>,
    /// From the axis to the centre of that mass, m.
    pub lever_m: Option<f64>,
    /// The motor's data sheet.
    pub motor: Motor,
    /// Numbers of `[model]` that are stated as they are.
    pub numbers: BTreeMap<String, f64>,
    /// Their relative standard deviations.
    pub tolerances: BTreeMap<String, f64>,
}

/// A motor's data sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Torque constant, N m/A.
    pub kt: Option<f64>,
    /// Of the winding, Ω.
    pub resistance: Option<f64>,
    /// Of the rotor, kg m².
    pub rotor_inertia: Option<f64>,
    /// Of the supply, V, where the input is a duty cycle.
    pub supply: Option<f64>,
}

impl Motor {
    /// The keys of [`set`](Self::set).
    pub const NAMES: [&str; 4] = ["kt", "resistance", "rotor_inertia", "supply"];

    /// Sets one number; false if none is called so.
    #[must_use]
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        match name {
            "kt" => self.kt = Some(value),
            "resistance" => self.resistance = Some(value),
            "rotor_inertia" => self.rotor_inertia = Some(value),
            "supply" => self.supply = Some(value),
            _ => return false,
        }
        true
    }
}

/// A number of `[model]`, and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Number {
    pub value: f64,
    pub why: String,
}

impl Known {
    /// The numbers of `[model]` that follow for an input in `unit`.
    ///
    /// # Errors
    /// [`ImportError::Option`] for names that no model has and for numbers that contradict the input's unit.
    pub(crate) fn numbers(
        &self,
        unit: &str,
    ) -> Result<BTreeMap<&'static str, Number>, ImportError> {
        let mut numbers = BTreeMap::new();
        let mut put = |name, value, why: String| {
            numbers.insert(name, Number { value, why });
        };
        let gear = self.gear.unwrap_or(1.0);
        let Motor {
            kt,
            resistance,
            rotor_inertia,
            supply,
        } = self.motor;
        let is_voltage = matches!(unit, "V" | "duty");
        match (unit, kt, resistance, supply) {
            ("A", Some(kt), ..) => put(
                "ratio",
                gear * kt,
                format!("gear {gear} times kt {kt} N m/A"),
            ),
            ("V", Some(kt), Some(r), _) => put(
                "ratio",
                gear * kt / r,
                format!("gear {gear} times kt {kt} N m/A over {r} Ohm"),
            ),
            ("duty", Some(kt), Some(r), Some(v)) => {
                put(
                    "ratio",
                    gear * kt * v / r,
                    format!("gear {gear} times kt {kt} N m/A times {v} V over {r} Ohm"),
                );
            }
            ("duty", Some(_), Some(_), None) => {
                return Err(ImportError::Option(
                    "the input is a duty cycle; state the supply, too: --motor supply=VOLTS".into(),
                ));
            }
            ("V" | "duty", Some(_), None, _) => {
                return Err(ImportError::Option("the input is a voltage; state the winding's resistance, too: --motor resistance=OHM".into()));
            }
            ("N m" | "N", ..) if self.gear.is_some() => put(
                "ratio",
                gear,
                format!("gear {gear}; the input is at the motor"),
            ),
            _ => {}
        }
        if let (true, Some(kt), Some(r)) = (is_voltage, kt, resistance) {
            let value = gear * gear * kt * kt / r;
            put(
                "viscous",
                value,
                "of the motor's back-EMF alone, gear² kt²/resistance; friction comes on top".into(),
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
                let rotor = rotor_inertia.map_or(0.0, |rotor| gear * gear * rotor);
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
    fn a_data_sheet_gives_ratio_and_back_emf() {
        let motor = Motor {
            kt: Some(0.0538),
            resistance: Some(10.6),
            ..Motor::default()
        };
        let known = Known {
            gear: Some(15.0),
            motor,
            ..Known::default()
        };
        let value = |unit, name| {
            known
                .numbers(unit)
                .unwrap()
                .get(name)
                .map(|number| number.value)
        };
        assert_eq!(value("A", "ratio"), Some(15.0 * 0.0538));
        assert_eq!(value("A", "viscous"), None);
        assert_eq!(value("V", "ratio"), Some(15.0 * 0.0538 / 10.6));
        let back_emf = value("V", "viscous").unwrap();
        assert!(
            (back_emf - 225.0 * 0.0538 * 0.0538 / 10.6).abs() < 1e-12,
            "{back_emf}"
        );
        assert!(known.numbers("duty").is_err());
        assert_eq!(value("N m", "ratio"), Some(15.0));
    }
}
