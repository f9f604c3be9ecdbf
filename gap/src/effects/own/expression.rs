//! The torque of a user's effect, as an expression that is compiled once.

use super::error::OwnEffectError;
use exmex::{Express, FlatEx};
use host_sim::plant::{Moment, TorqueLaw};

/// Names of what a torque may depend on beside its parameters: position, velocity, acting input and time of the session.
pub(super) const VARIABLES: [&str; 4] = ["x", "v", "u", "t"];

/// A compiled expression.
#[derive(Debug)]
pub(super) struct Expression {
    text: String,
    compiled: FlatEx<f64>,
    /// The variable or parameter behind each name, in the order in which the crate takes values.
    places: Vec<Place>,
}

/// Writes a leading minus as a difference from 0, `0-x^2` for `-x^2`: the crate would read `-x^2` as `(-x)^2`.
fn with_usual_signs(text: &str) -> String {
    let mut usual = String::with_capacity(text.len() + 8);
    let mut begins = true;
    for c in text.chars() {
        if c == '-' && begins {
            usual.push('0');
        }
        usual.push(c);
        begins = matches!(c, '(' | ',') || (begins && c.is_whitespace());
    }
    usual
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Variable(usize),
    Parameter(usize),
}

impl Expression {
    /// Compiles `text` with these names of parameters.
    ///
    /// # Errors
    /// [`OwnEffectError::Expression`], [`OwnEffectError::UnknownName`] and [`OwnEffectError::Unused`].
    pub(super) fn compiled(text: &str, parameters: &[String]) -> Result<Self, OwnEffectError> {
        let compiled = exmex::parse::<f64>(&with_usual_signs(text)).map_err(|why| {
            OwnEffectError::Expression {
                text: text.to_owned(),
                why: why.to_string(),
            }
        })?;
        let place = |name: &String| {
            let variable = VARIABLES.iter().position(|known| known == name);
            let parameter = || parameters.iter().position(|known| known == name);
            variable
                .map(Place::Variable)
                .or_else(|| parameter().map(Place::Parameter))
                .ok_or_else(|| OwnEffectError::UnknownName(name.clone()))
        };
        let names = compiled.var_names();
        let unused = parameters.iter().find(|name| !names.contains(name));
        if let Some(unused) = unused {
            return Err(OwnEffectError::Unused(unused.clone()));
        }
        let places = names.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self {
            text: text.to_owned(),
            compiled,
            places,
        })
    }
}

/// Most names of an expression: its variables and parameters.
const MOST_NAMES: usize = VARIABLES.len() + super::definition::MOST_PARAMETERS;

impl TorqueLaw for Expression {
    fn torque_nm(&self, at: &Moment, parameters: &[f64]) -> f64 {
        let variables = [at.position, at.velocity, at.input, at.time_s];
        let mut values = [0.0; MOST_NAMES];
        for (value, place) in values.iter_mut().zip(&self.places) {
            *value = match *place {
                Place::Variable(place) => variables[place],
                Place::Parameter(place) => parameters.get(place).copied().unwrap_or(f64::NAN),
            };
        }
        let torque = self.compiled.eval(&values[..self.places.len()]);
        torque.unwrap_or(f64::NAN)
    }

    fn text(&self) -> String {
        self.text.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_before_a_power_is_that_of_the_power() {
        for (text, expected) in [
            ("-x^2", -9.0),
            ("exp( -x^2)", (-9.0f64).exp()),
            ("2 - x", -1.0),
            ("max(-x^2, -x)", -3.0),
            ("x^-2", 1.0 / 9.0),
        ] {
            let law = Expression::compiled(text, &[]).expect(text);
            let at = Moment {
                position: 3.0,
                velocity: 0.0,
                input: 0.0,
                time_s: 0.0,
            };
            let torque = law.torque_nm(&at, &[]);
            assert!((torque - expected).abs() < 1e-12, "{text}: {torque}");
        }
    }
}
