//! Detects fitted effects that compensate another cause: with a parameter value that no device has, or with one at which the effect acts
//! as another one.

use crate::effects::{self, Fitted};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::term::{Scale, Term};
use host_sim::effects::{Parameter, Quantity};
use recording::Model;
use std::fmt;

/// Factor outside of the typical range beyond which a value is implausible.
const FAR: f64 = 3.0;
/// The stated inertia of the paddle, to which the typical inertias refer, kg m².
const PADDLE_INERTIA: f64 = 5.755e-4;

/// True if no effect of a fit has an implausible value, and each acts as its name says.
pub(crate) fn is_plausible(problem: &Problem<'_>, fit: &Fit) -> bool {
    Implausible::has_none(problem, fit) && is_true_to_names(problem, fit)
}

/// True if every effect of a fit acts as its name says.
pub(crate) fn is_true_to_names(problem: &Problem<'_>, fit: &Fit) -> bool {
    fit.hypothesis.parts(&fit.x).all(|(term, x)| {
        let term = term.moved(x);
        is_repeated(problem, &term) && !acts_as_another(problem, fit, &term)
    })
}

/// True if an effect of a fit, with its fitted values, acts as another effect does at these values.
fn acts_as_another(problem: &Problem<'_>, fit: &Fit, fitted: &Term) -> bool {
    effects::of(fitted.kind.name).is_degenerate(&Fitted {
        term: fitted,
        device: problem.predictor(&fit.hypothesis, &fit.x).device(),
        series: &problem.series,
        horizon_s: problem.recording.horizon,
        resolution: problem.recording.sensor("position").resolution,
    })
}

/// True if an effect is not periodic, or the recording travels at least one of its periods.
fn is_repeated(problem: &Problem<'_>, fitted: &Term) -> bool {
    let effect = effects::of(fitted.kind.name);
    effect.too_few_periods(fitted, problem.extremes()).is_none()
}

/// An implausible parameter value of an effect.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Implausible {
    /// The effect.
    pub effect: &'static str,
    parameter: String,
    value: f64,
    is_at_end: bool,
}

impl Implausible {
    /// True if no effect of a fit has an implausible value.
    fn has_none(problem: &Problem<'_>, fit: &Fit) -> bool {
        let mut places = 0..fit.hypothesis.terms.len();
        places.all(|place| Self::of(problem, fit, place).is_none())
    }

    /// The first implausible value of the effect at `place` in a fit, if any. An effect that estimates an unstated model parameter may
    /// have any value.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit, place: usize) -> Option<Self> {
        let (term, x) = fit.hypothesis.parts(&fit.x).nth(place)?;
        let number = effects::of(term.kind.name).main_number();
        if number.is_some_and(|number| problem.recording.unstated.contains(&number.name)) {
            return None;
        }
        let values = term.at(x);
        let model = &problem.recording.model;
        let mut free = term.free.iter().zip(x);
        free.find_map(|(coordinate, x)| {
            let parameter = term.kind.parameter(coordinate.parameter);
            let value = values[coordinate.parameter];
            let [low, high] = coordinate.reach(parameter);
            let is_at_end = !(low..high).contains(x) && is_unusual(parameter, value, model, 1.0);
            // The first parameter of an effect is its magnitude. For the other parameters a value far outside is only implausible if they
            // are logarithmic.
            let is_size = coordinate.parameter == 0 || coordinate.scale == Scale::Log;
            let is_far = is_size && is_unusual(parameter, value, model, FAR);
            (is_at_end || is_far).then(|| Self {
                effect: term.kind.name,
                parameter: name(term, coordinate.parameter),
                value,
                is_at_end,
            })
        })
    }
}

fn name(term: &Term, parameter: usize) -> String {
    term.kind.value_name(parameter, term.values.len())
}

/// True if a dimensionless parameter or an inertia is outside of its typical range by `factor`. Other quantities depend on the
/// device.
fn is_unusual(parameter: &Parameter, value: f64, model: &Model, factor: f64) -> bool {
    let [low, high] = parameter.typical;
    let size = match parameter.quantity {
        Quantity::Ratio => value,
        Quantity::Inertia => value / model.inertia * PADDLE_INERTIA,
        _ => return false,
    };
    let is_below = low > 0.0 && size < low / factor;
    let is_outside =
        size > factor * high.abs().max(low.abs()) || (low < 0.0 && size < factor * low);
    is_below || is_outside
}

impl fmt::Display for Implausible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            parameter, value, ..
        } = self;
        if self.is_at_end {
            write!(f, "its {parameter} ends at a bound, {value:.3}")
        } else {
            write!(
                f,
                "its {parameter} of {value:.3} is far outside of the typical range"
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    fn implausible(name: &str, start: f64) -> bool {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let free = Coordinate {
            parameter: 0,
            start,
            scale: Scale::Log,
        };
        let hypothesis = Hypothesis {
            terms: vec![made::term(name, &[free])],
        };
        let fit = problem.fit(&hypothesis, vec![0.0], Part::All, 0);
        Implausible::of(&problem, &fit, 0).is_some()
    }

    #[test]
    fn a_ripple_of_which_less_than_a_period_was_travelled_does_not_act_as_its_name_says() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let [low, high] = problem.extremes();
        let is_true = |periods: f64| {
            let mut ripple = made::term("cogging", &[]);
            ripple.values[1] = periods * core::f64::consts::TAU / (high - low);
            let hypothesis = Hypothesis {
                terms: vec![ripple],
            };
            let fit = problem.fit(&hypothesis, Vec::new(), Part::All, 0);
            is_true_to_names(&problem, &fit)
        };
        assert_eq!([0.5, 3.0].map(is_true), [false, true]);
    }

    #[test]
    fn values_far_outside_of_their_typical_range_are_implausible() {
        for (name, size) in [
            ("torque_gain", 0.015),
            ("sensor_gain", 0.0025),
            ("inertia", 62.0 * 5.755e-4),
            ("stribeck", 31.0),
        ] {
            assert!(implausible(name, size), "{name} {size}");
        }
        for (name, size) in [
            ("torque_gain", 0.7),
            ("sensor_gain", 1.3),
            ("inertia", 2.0 * 5.755e-4),
            ("stribeck", 2.0),
            ("viscous", 1e3),
        ] {
            assert!(!implausible(name, size), "{name} {size}");
        }
    }
}
