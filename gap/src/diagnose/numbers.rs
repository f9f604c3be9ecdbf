//! The numbers of the model that had to move, or that are not stated.

use super::attribution::{Attributed, Cause};
use super::findings::PREDICTION;
use crate::diagnosis::{Estimate, Finding, NumberFinding};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::INPUT_TIME;
use crate::fit::problem::Problem;
use host_sim::effects::Quantity;
use recording::Recording;

/// Name of the delay in the model.
const DELAY: &str = "delay";

/// Share of the gap that the move of a number must close to be said.
const LEAST_SHRINK: f64 = 0.05;

/// The numbers that a fit had to move, in the order of what they account for. Numbers that are not stated are always said.
pub(super) fn moved(
    problem: &Problem<'_>,
    fit: &Fit,
    attributed: &[Attributed],
) -> Vec<NumberFinding> {
    let numbers = attributed.iter().filter_map(|part| match part.cause {
        Cause::Number(place) => {
            let is_said = part.shrink[0] >= LEAST_SHRINK;
            is_said.then(|| stated(problem, fit, place, part.shrink))
        }
        Cause::Effect(place) => estimated(problem, fit, place, part.shrink),
    });
    numbers.collect()
}

/// A number that is stated, as it was found.
fn stated(problem: &Problem<'_>, fit: &Fit, place: usize, shrink: [f64; 3]) -> NumberFinding {
    let number = &problem.priors[place];
    let moved_by = fit.x[place];
    // By how much later the input acts is a delay on top of the one that is stated.
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

/// A number that is not stated, as it was found; none if the effect at that place stands for none.
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
    // A number that only scales the others is said as a multiple of what is assumed.
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

/// Stated standard deviations beyond which a number that moved is an effect.
const BEYOND_TOLERANCE: f64 = 3.0;
/// Probability that such an effect is the right name. Another number or effect may have been missing in its place: of 13 such names on a
/// blind set with mess 6 were right.
const SURE_BEYOND_TOLERANCE: f64 = 0.45;

/// The numbers that moved beyond what is stated of them, or that were stated as exact, as effects, but for those that are `named`
/// already.
pub(super) fn beyond_tolerance(
    numbers: &[NumberFinding],
    named: &[&str],
    most_sure: f64,
) -> Vec<Finding> {
    let far = numbers.iter().filter(|number| {
        let is_within = number
            .sigmas
            .is_some_and(|sigmas| sigmas <= BEYOND_TOLERANCE);
        number.stated.is_some() && !is_within
    });
    let findings = far.filter_map(|number| {
        let effect = effects::replacing(&number.name)?;
        let kind = effect.kind();
        let is_named = named.contains(&kind.name);
        // A number that only scales the others is said as a multiple of what is stated.
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
            confidence: SURE_BEYOND_TOLERANCE.min(most_sure),
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

/// Unit of a number of the model.
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
    fn a_number_that_moved_beyond_what_is_stated_of_it_is_an_effect() {
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
