//! Parameters at which a fit may have stalled: at a bound of their range, or where nothing recorded depends on them. The derivative there
//! says nothing, so their uncertainty is unknown.

use super::fitted::Fit;
use super::hypothesis::PriorParameter;
use std::fmt;

/// Distance from a bound, as a share of the range, within which a coordinate counts as at the bound.
const AT_END: f64 = 1e-6;

/// A parameter at which a fit may have stalled.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stall {
    /// A model parameter at a bound of its range.
    Model { name: String },
    /// A parameter of an effect at a bound of its range.
    Effect {
        effect: &'static str,
        name: String,
        is_upper: bool,
    },
    /// A parameter of an effect on which no recorded sample depends near its value, such as an instant between two runs.
    Idle { effect: &'static str, name: String },
}

impl Fit {
    /// The parameters of model and effects at a bound of their range, and the parameters of effects without influence at their value.
    pub(crate) fn stalls(&self, priors: &[PriorParameter]) -> Vec<Stall> {
        let reaches = self.hypothesis.reaches(priors);
        let mut ends = self
            .x
            .iter()
            .zip(&reaches)
            .map(|(x, reach)| end(*x, *reach));
        let of_model = priors.iter().zip(&mut ends);
        let of_model = of_model.filter(|(_, end)| end.is_some());
        let mut all: Vec<Stall> = of_model
            .map(|(prior, _)| Stall::Model {
                name: prior.name.clone(),
            })
            .collect();
        let terms = self.hypothesis.terms.iter();
        let free = terms.flat_map(|term| term.free.iter().map(move |c| (term, c.parameter)));
        let deviations = self.std.iter().skip(priors.len());
        let of_effects = free.zip(ends).zip(deviations);
        all.extend(of_effects.filter_map(|(((term, place), end), std)| {
            let effect = term.kind.name;
            let name = term.kind.value_name(place, term.values.len());
            match end {
                Some(is_upper) => Some(Stall::Effect {
                    effect,
                    name,
                    is_upper,
                }),
                None => (*std == 0.0).then_some(Stall::Idle { effect, name }),
            }
        }));
        all
    }
}

impl Stall {
    /// True if this is the parameter `name` of the effect `kind`.
    pub(crate) fn is_of(&self, kind: &str, name: &str) -> bool {
        match self {
            Self::Model { .. } => false,
            Self::Effect {
                effect, name: own, ..
            }
            | Self::Idle { effect, name: own } => *effect == kind && own == name,
        }
    }
}

/// `Some(true)` if a coordinate is at its upper bound, `Some(false)` if it is at its lower bound.
fn end(x: f64, [low, high]: [f64; 2]) -> Option<bool> {
    let near = AT_END * (high - low);
    let is_upper = x >= high - near;
    (is_upper || x <= low + near).then_some(is_upper)
}

impl fmt::Display for Stall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model { name } => write!(
                f,
                "the fit moves {name} to the limit of its tolerance: check both the value and the tolerance in the model"
            ),
            Self::Effect {
                effect,
                name,
                is_upper,
            } => {
                let end = if *is_upper { "highest" } else { "lowest" };
                write!(
                    f,
                    "the fit of {effect} ends with {name} at its {end} possible value, where a fit may stall: its uncertainty is unknown"
                )
            }
            Self::Idle { effect, name } => write!(
                f,
                "no recorded sample depends on the {name} of {effect} near its fitted value: its uncertainty is unknown"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::Hypothesis;
    use crate::term::{Coordinate, Scale, Term};
    use host_sim::effects;

    #[test]
    fn parameters_at_a_bound_or_without_influence_are_named() {
        let kind = effects::kind("presliding").unwrap();
        let values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
        let elastic = kind.parameters.iter().position(|p| p.name == "elastic");
        let elastic = elastic.unwrap();
        let free = [0, elastic].map(|parameter| Coordinate {
            parameter,
            start: values[parameter],
            scale: Scale::Linear(0.1 * values[parameter].max(1.0)),
        });
        let highest = (kind.parameter(elastic).range[1] - values[elastic]) / 0.1;
        let term = Term {
            kind,
            values,
            free: free.to_vec(),
            sensor_on_load: false,
        };
        let prior = |name: &str| PriorParameter {
            name: name.to_owned(),
            value: 1.0,
            relative: 0.02,
            is_stated: true,
        };
        let priors = [prior("inertia"), prior("viscous")];
        let at = |x: [f64; 4], std: [f64; 4]| {
            let fit = Fit {
                hypothesis: Hypothesis {
                    terms: vec![term.clone()],
                },
                x: x.to_vec(),
                std: std.to_vec(),
                costs: Costs {
                    per_sample: Vec::new(),
                    prior: 0.0,
                },
            };
            let stalls = fit.stalls(&priors);
            stalls.iter().map(Stall::to_string).collect::<Vec<_>>()
        };
        const KNOWN: [f64; 4] = [0.1; 4];
        let inside = [1.0, -4.9, 0.1, highest - 0.01];
        assert_eq!(at(inside, KNOWN), [""; 0]);
        let [idle] = at(inside, [0.1, 0.1, 0.1, 0.0]).try_into().unwrap();
        assert!(idle.contains("elastic of presliding"), "{idle}");
        let ends = at([1.0, -5.0, 0.1, highest], KNOWN);
        let [viscous, elastic] = ends.try_into().unwrap();
        assert!(viscous.contains("moves viscous"), "{viscous}");
        assert!(
            elastic.contains("presliding ends with elastic at its highest"),
            "{elastic}"
        );
    }
}
