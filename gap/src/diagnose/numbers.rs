//! The model parameters that moved, or that are not stated.

use super::attribution::{Attributed, Cause};
use super::findings::PREDICTION;
use crate::diagnosis::{Estimate, Finding, NumberFinding};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::{INPUT_TIME, MOST_STATED_DEVIATIONS};
use crate::fit::problem::Problem;
use host_sim::effects::Quantity;
use recording::Recording;

/// Name of the delay in the model.
const DELAY: &str = "delay";

/// Least share of the gap that a moved parameter must close to be reported.
const LEAST_SHRINK: f64 = 0.05;

/// The parameters that a fit moved, in the order of their shares of the shrink. Parameters without a stated value are always reported.
pub(super) fn moved(
    problem: &Problem<'_>,
    fit: &Fit,
    attributed: &[Attributed],
) -> Vec<NumberFinding> {
    let numbers = attributed.iter().filter_map(|part| match part.cause {
        Cause::Number(place) => {
            let is_reported = part.shrink[0] >= LEAST_SHRINK;
            is_reported.then(|| stated(problem, fit, place, part.shrink))
        }
        Cause::Effect(place) => estimated(problem, fit, place, part.shrink),
    });
    numbers.collect()
}

/// The finding of a parameter with a stated value.
fn stated(problem: &Problem<'_>, fit: &Fit, place: usize, shrink: [f64; 3]) -> NumberFinding {
    let number = &problem.priors[place];
    let moved_by = fit.x[place];
    // An additional delay of the input is added to the stated delay.
    let (name, stated, at): (_, _, &dyn Fn(f64) -> f64) = if number.name == INPUT_TIME {
        let stated_s = problem.recording.model.delay;
        (DELAY, stated_s, &move |z| stated_s + z * number.value)
    } else {
        (&*number.name, number.value, &|z| number.at(z))
    };
    let found = at(moved_by);
    let spread = at(moved_by + fit.std[place]) - found;
    let [value, low, high] = shrink;
    NumberFinding {
        name: name.to_owned(),
        stated: Some(stated),
        found,
        std: spread.is_finite().then_some(spread.abs()),
        sigmas: number.is_stated.then_some(moved_by.abs()),
        shrink: value,
        shrink_interval: [low, high],
        unit: unit(name, problem.recording),
    }
}

/// The finding of a parameter without a stated value. Returns `None` if the effect at that index does not estimate such a parameter.
fn estimated(
    problem: &Problem<'_>,
    fit: &Fit,
    place: usize,
    shrink: [f64; 3],
) -> Option<NumberFinding> {
    let recording = problem.recording;
    let (term, x) = fit.hypothesis.parts(&fit.x).nth(place)?;
    let (_, std) = fit.hypothesis.parts(&fit.std).nth(place)?;
    let number = effects::of(term.kind.name).main_number()?;
    let name = number.name;
    if !recording.unstated.contains(&name) {
        return None;
    }
    // A parameter that only scales the others is estimated as a multiple of the assumed value.
    let assumed = match number.usual_error {
        None => recording.model.get(name).unwrap_or(1.0),
        Some(_) => 1.0,
    };
    let spread = assumed * term.spread(0, x, std);
    let [value, low, high] = shrink;
    Some(NumberFinding {
        name: name.to_owned(),
        stated: None,
        found: assumed * term.at(x)[0],
        std: spread.is_finite().then_some(spread.abs()),
        sigmas: None,
        shrink: value,
        shrink_interval: [low, high],
        unit: unit(name, recording),
    })
}

/// Confidence in a moved parameter that counts as an effect. Another parameter or effect may be the cause.
const SURE_BEYOND_TOLERANCE: f64 = 0.45;

impl NumberFinding {
    /// True if it moved within its stated tolerance, or has no stated value.
    pub(super) fn is_within_tolerance(&self) -> bool {
        let sigmas = self.sigmas;
        self.stated.is_none() || sigmas.is_some_and(|sigmas| sigmas <= MOST_STATED_DEVIATIONS)
    }
}

/// The parameters that moved beyond their tolerances, or that were stated as exact, as effects. Effects that are already `named` are left
/// out.
pub(super) fn beyond_tolerance(
    numbers: &[NumberFinding],
    named: &[&str],
    confidence_limit: f64,
) -> Vec<Finding> {
    let beyond = numbers
        .iter()
        .filter(|number| !number.is_within_tolerance());
    let findings = beyond.filter_map(|number| {
        let effect = effects::replacing(&number.name)?;
        let kind = effect.kind();
        let is_named = named.contains(&kind.name);
        // A parameter that only scales the others is reported as a multiple of the stated value.
        let is_scale = effect
            .main_number()
            .is_some_and(|main| main.usual_error.is_none());
        let unit = if is_scale { number.stated? } else { 1.0 };
        let estimate = Estimate {
            value: number.found / unit,
            std: number.std.map(|std| std / unit.abs()),
            unit: if is_scale {
                "1".to_owned()
            } else {
                number.unit.clone()
            },
            is_fitted: true,
        };
        (!is_named).then(|| Finding {
            name: kind.name,
            channel: kind.channel.name(),
            confidence: SURE_BEYOND_TOLERANCE.min(confidence_limit),
            not_separable_from: Vec::new(),
            basis: PREDICTION,
            held_out: true,
            parameters: [(kind.parameters[0].name.to_owned(), estimate)].into(),
            shrink: number.shrink,
            shrink_interval: number.shrink_interval,
        })
    });
    findings.collect()
}

/// Unit of a model parameter.
fn unit(name: &str, recording: &Recording) -> String {
    let units = &recording.units;
    let of = |quantity: Quantity| quantity.unit(&units.position, &units.input);
    let ratio = || format!("{}/({})", of(Quantity::Torque), units.input);
    Quantity::of_model(name).map_or_else(ratio, of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(stated: Option<f64>, sigmas: Option<f64>) -> NumberFinding {
        NumberFinding {
            name: "coulomb".into(),
            stated,
            found: 0.05,
            std: Some(0.001),
            sigmas,
            shrink: 0.4,
            shrink_interval: [0.3, 0.5],
            unit: "N m".into(),
        }
    }

    fn named(stated: Option<f64>, sigmas: Option<f64>) -> Vec<&'static str> {
        let findings = beyond_tolerance(&[number(stated, sigmas)], &[], 1.0);
        findings.iter().map(|finding| finding.name).collect()
    }

    #[test]
    fn a_parameter_beyond_its_tolerance_is_reported_as_an_effect() {
        assert_eq!(
            named(Some(0.02), Some(2.0)),
            [""; 0],
            "within its tolerance"
        );
        assert_eq!(named(Some(0.02), Some(3.5)), ["coulomb"], "beyond it");
        assert_eq!(named(Some(0.02), None), ["coulomb"], "stated as exact");
        assert_eq!(named(None, None), [""; 0], "not stated");
    }
}
