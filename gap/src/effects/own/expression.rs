//! The torque of a user's effect, as an expression that is compiled once.

use super::error::OwnEffectError;
use formula::Formula;
use host_sim::plant::{Moment, TorqueLaw};

/// Names of the variables of a torque: position, velocity, acting input, and time of the session.
pub(super) const VARIABLES: [&str; 4] = ["x", "v", "u", "t"];

/// A compiled expression.
#[derive(Debug)]
pub(super) struct Expression {
    formula: Formula,
    /// The variable or parameter of each name, in the order in which the crate `formula` takes values.
    sources: Vec<Source>,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Variable(usize),
    Parameter(usize),
}

impl Expression {
    /// Compiles `text` with the given parameter names.
    ///
    /// # Errors
    ///
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
                .map(Source::Variable)
                .or_else(|| parameter().map(Source::Parameter))
                .ok_or_else(|| OwnEffectError::UnknownName(name.clone()))
        };
        let names = formula.names();
        let unused = parameters.iter().find(|name| !names.contains(name));
        if let Some(unused) = unused {
            return Err(OwnEffectError::Unused(unused.clone()));
        }
        let sources = names.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { formula, sources })
    }
}

/// Largest number of names in an expression: its variables and parameters.
const MOST_NAMES: usize = VARIABLES.len() + super::definition::MOST_PARAMETERS;

impl TorqueLaw for Expression {
    fn torque_nm(&self, at: &Moment, parameters: &[f64]) -> f64 {
        let variables = [at.position, at.velocity, at.input, at.time_s];
        let mut values = [0.0; MOST_NAMES];
        for (value, place) in values.iter_mut().zip(&self.sources) {
            *value = match *place {
                Source::Variable(place) => variables[place],
                Source::Parameter(place) => parameters.get(place).copied().unwrap_or(f64::NAN),
            };
        }
        self.formula.value(&values[..self.sources.len()])
    }

    fn text(&self) -> String {
        self.formula.text().to_owned()
    }
}
