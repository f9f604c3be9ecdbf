//! The torque of a user's effect, as an expression that is compiled once.

use super::error::OwnEffectError;
use formula::Formula;
use host_sim::plant::{Moment, TorqueLaw};

/// Names of what a torque may depend on beside its parameters: position, velocity, acting input and time of the session.
pub(super) const VARIABLES: [&str; 4] = ["x", "v", "u", "t"];

/// A compiled expression.
#[derive(Debug)]
pub(super) struct Expression {
    formula: Formula,
    /// The variable or parameter behind each name, in the order in which the crate takes values.
    places: Vec<Place>,
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
        let formula = Formula::parse(text).map_err(|why| OwnEffectError::Expression {
            text: text.to_owned(),
            why,
        })?;
        let place = |name: &String| {
            let variable = VARIABLES.iter().position(|known| known == name);
            let parameter = || parameters.iter().position(|known| known == name);
            variable
                .map(Place::Variable)
                .or_else(|| parameter().map(Place::Parameter))
                .ok_or_else(|| OwnEffectError::UnknownName(name.clone()))
        };
        let names = formula.names();
        let unused = parameters.iter().find(|name| !names.contains(name));
        if let Some(unused) = unused {
            return Err(OwnEffectError::Unused(unused.clone()));
        }
        let places = names.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { formula, places })
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
        self.formula.value(&values[..self.places.len()])
    }

    fn text(&self) -> String {
        self.formula.text().to_owned()
    }
}
