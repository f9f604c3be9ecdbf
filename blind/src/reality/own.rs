//! A torque that a user's formula gives.

use std::sync::Arc;

use formula::Formula;

use super::Motion;

/// A torque on the load as a formula of its motion, the input and the time.
#[derive(Clone, Debug)]
pub(crate) struct OwnTorque {
    formula: Arc<Formula>,
    /// The quantities of the formula, in the order in which it takes them.
    arguments: Vec<Argument>,
}

#[derive(Clone, Copy, Debug)]
enum Argument {
    Position,
    Velocity,
    Input,
    Time,
    Parameter(f64),
}

impl OwnTorque {
    /// The torque of `formula` with `parameters` by name. A name that is no parameter and no quantity makes it undefined.
    pub fn new(formula: Arc<Formula>, parameters: &[(&str, f64)]) -> Self {
        let arguments = formula.names().iter().map(|name| match name.as_str() {
            "x" => Argument::Position,
            "v" => Argument::Velocity,
            "u" => Argument::Input,
            "t" => Argument::Time,
            other => {
                let parameter = parameters.iter().find(|(name, _)| *name == other);
                Argument::Parameter(parameter.map_or(f64::NAN, |(_, value)| *value))
            }
        });
        Self {
            arguments: arguments.collect(),
            formula,
        }
    }

    /// Torque on the load, N m. `input` is the torque of the drive over the ratio.
    pub fn torque(&self, load: Motion, input: f64, time_s: f64) -> f64 {
        let value = |argument: &Argument| match *argument {
            Argument::Position => load.x,
            Argument::Velocity => load.v,
            Argument::Input => input,
            Argument::Time => time_s,
            Argument::Parameter(value) => value,
        };
        let values: Vec<f64> = self.arguments.iter().map(value).collect();
        self.formula.value(&values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_takes_motion_input_time_and_parameters_by_name() {
        let formula = Formula::parse("k * u * x + v - t").unwrap();
        let torque = OwnTorque::new(Arc::new(formula), &[("k", 2.0)]);
        let value = torque.torque(Motion { x: 3.0, v: 5.0 }, 7.0, 11.0);
        assert!((value - 36.0).abs() < 1e-12, "{value}");
    }
}
