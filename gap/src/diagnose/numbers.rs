//! The stated numbers of the model that had to move.

use super::findings::PREDICTION;
use crate::diagnosis::{Estimate, Finding, NumberFinding};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::shrink::shrink;
use host_sim::effects::Quantity;
use recording::Recording;

/// Share of the gap that the move of a number must close to be said.
const LEAST_SHRINK: f64 = 0.05;
/// Standard deviations of its own estimate that it must have moved.
const SURE: f64 = 2.0;
const ITERATIONS: usize = 6;

/// The numbers that a fit had to move, those that close most first. What a move closes is the mean of what it closes alone and
/// beside the moves of all others, each refitted: half-way between the two ends of its Shapley share. Numbers that are not stated
/// are always said. `nominal` and `floor` are squares by window.
pub(super) fn moved(
    problem: &Problem<'_>,
    fit: &Fit,
    nominal: &[f64],
    floor: &[f64],
) -> Vec<NumberFinding> {
    let with = problem.window_squares(fit, Part::All);
    let none = left_with(problem, fit, |_| false);
    let numbers = problem.nudges.iter().enumerate();
    let mut all: Vec<NumberFinding> = numbers
        .filter(|(place, number)| {
            fit.x[*place] != 0.0 && problem.recording.model.get(&number.name).is_some()
        })
        .filter_map(|(place, number)| {
            let alone = left_with(problem, fit, |other| other == place);
            let others = left_with(problem, fit, |other| other != place);
            let [alone, ..] = shrink(&none, &alone, floor, nominal);
            let [beside, low, high] = shrink(&others, &with, floor, nominal);
            let share = 0.5 * (alone + beside);
            let moved_by = fit.x[place];
            if moved_by.abs() <= SURE * fit.std[place] {
                return None;
            }
            let found = number.at(moved_by);
            let spread = number.at(moved_by + fit.std[place]) - found;
            (share >= LEAST_SHRINK).then(|| NumberFinding {
                name: number.name.clone(),
                stated: Some(number.value),
                found,
                std: spread.is_finite().then_some(spread.abs()),
                sigmas: Some(moved_by.abs()),
                shrink: share,
                shrink_interval: [low, high],
                unit: unit(&number.name, problem.recording),
            })
        })
        .collect();
    all.extend(estimated(problem, fit, &with, nominal, floor));
    all.sort_by(|a, b| b.shrink.total_cmp(&a.shrink));
    all
}

/// Stated standard deviations beyond which a number that moved is an effect.
const BEYOND_TOLERANCE: f64 = 3.0;
/// Probability that such an effect is what the number moved for: without it another one might have moved.
const SURE_BEYOND_TOLERANCE: f64 = 0.6;

/// The numbers that moved beyond what is stated of them, as effects, but for those that are `named` already.
pub(super) fn beyond_tolerance(
    numbers: &[NumberFinding],
    named: &[Finding],
    most_sure: f64,
) -> Vec<Finding> {
    let far = numbers.iter().filter(|number| {
        let sigmas = number.sigmas.unwrap_or(0.0);
        sigmas > BEYOND_TOLERANCE
    });
    let findings = far.filter_map(|number| {
        let effect = effects::replacing(&number.name)?;
        let kind = effect.kind();
        let is_named = named.iter().any(|finding| finding.name == kind.name);
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

/// Squares of each window where only those numbers have moved that are `free`, refitted with the effects of a fit.
fn left_with(problem: &Problem<'_>, fit: &Fit, free: impl Fn(usize) -> bool) -> Vec<f64> {
    let count = problem.nudges.len();
    let kept: Vec<usize> = (0..count).filter(|place| free(*place)).collect();
    let numbers: Vec<_> = kept.iter().map(|&k| problem.nudges[k].clone()).collect();
    let x = kept.iter().map(|&place| fit.x[place]);
    let x = x.chain(fit.x[count..].iter().copied()).collect();
    let held = problem.off_by(problem.modelling).with_numbers(&numbers);
    let held_fit = held.fit(&fit.hypothesis, x, Part::All, ITERATIONS);
    held.window_squares(&held_fit, Part::All)
}

/// The numbers that are not stated, as estimated.
fn estimated(
    problem: &Problem<'_>,
    fit: &Fit,
    with: &[f64],
    nominal: &[f64],
    floor: &[f64],
) -> Vec<NumberFinding> {
    let recording = problem.recording;
    let parts = fit
        .hypothesis
        .parts(&fit.x)
        .zip(fit.hypothesis.parts(&fit.std));
    let mut all = Vec::new();
    for (place, ((term, x), (_, std))) in parts.enumerate() {
        let number = effects::of(term.kind.name).main_number();
        let Some(number) = number.filter(|number| recording.unstated.contains(&number.name)) else {
            continue;
        };
        let name = number.name;
        let (hypothesis, x_without) = fit.without(place);
        let without = problem.fit(&hypothesis, x_without, Part::All, ITERATIONS);
        let without = problem.window_squares(&without, Part::All);
        let [share, low, high] = shrink(&without, with, floor, nominal);
        // A number that only scales the others is said as a multiple of what is assumed.
        let assumed = match number.usual_error {
            None => recording.model.get(name).unwrap_or(1.0),
            Some(_) => 1.0,
        };
        let found = assumed * term.at(x)[0];
        let spread = assumed * term.spread(0, x, std);
        all.push(NumberFinding {
            name: name.to_owned(),
            stated: None,
            found,
            std: spread.is_finite().then_some(spread.abs()),
            sigmas: None,
            shrink: share,
            shrink_interval: [low, high],
            unit: unit(name, recording),
        });
    }
    all
}

/// Unit of a number of the model.
fn unit(name: &str, recording: &Recording) -> String {
    let units = &recording.units;
    let of = |quantity: Quantity| quantity.unit(&units.position, &units.input);
    let ratio = || format!("{}/({})", of(Quantity::Torque), units.input);
    Quantity::of_model(name).map_or_else(ratio, of)
}
