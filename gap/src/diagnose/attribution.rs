//! How far each part of a corrected model closes the gap: its effects, and the numbers of the model that had to move.

use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::{INPUT_TIME, common_input_shift_s};
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::shapley;
use crate::shrink::{part_on_another, shrink};
use rayon::prelude::*;

const ITERATIONS: usize = 6;
/// Standard deviations of its own estimate by which a number must have moved.
const SURE: f64 = 2.0;
/// Standard deviations of what is stated below which a number is where it was.
const LEAST_MOVE: f64 = 0.01;

/// A part of a corrected model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A number that moved, by its place among those that may.
    Number(usize),
    /// An effect, by its place in the fit.
    Effect(usize),
}

/// What a part accounts for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attributed {
    pub cause: Cause,
    /// Its part of the shrink of the whole model, with its 95 % interval on another recording.
    pub shrink: [f64; 3],
}

/// Divides the `total` shrink of a fit, given with its 95 % interval, among its effects and the numbers that moved; `elsewhere` is the
/// 95 % interval of the total on another recording. The one that closes most comes first. Each part gets its Shapley share: subsets of
/// the parts are refitted, and what several parts can close is divided among them. `nominal` and `floor` are squared residuals by window,
/// in units of position squared.
pub(super) fn attributed(
    problem: &Problem<'_>,
    fit: &Fit,
    total: [f64; 3],
    elsewhere: [f64; 2],
    nominal: &[f64],
    floor: &[f64],
) -> Vec<Attributed> {
    let part = |cause, shrink| Attributed {
        cause,
        shrink: part_on_another(shrink, total[0], elsewhere),
    };
    let causes = causes(problem, fit);
    if let [cause] = causes[..] {
        return vec![part(cause, total)];
    }
    let is_taken = |subset: u32, cause: Cause| {
        let place = causes.iter().position(|other| *other == cause);
        place.is_some_and(|place| subset >> place & 1 == 1)
    };
    let subsets = shapley::subsets(causes.len()).into_par_iter();
    let left = subsets.map(|subset| {
        let squares = left_with(problem, fit, |cause| is_taken(subset, cause));
        (subset, squares)
    });
    let left: Vec<(u32, Vec<f64>)> = left.collect();
    let rms = left
        .iter()
        .map(|(subset, squares)| (*subset, problem.rms(squares)));
    let shares = shapley::shares(causes.len(), &rms.collect::<Vec<_>>());
    let positive = shares.iter().map(|share| share.of_all.max(0.0));
    let sum = positive.sum::<f64>().max(f64::MIN_POSITIVE);
    let with = problem.window_squares(fit, Part::All);
    let parts = causes.iter().zip(&shares).map(|(&cause, share)| {
        let own = total[0] * share.of_all.max(0.0) / sum;
        let others = left.iter().find(|(subset, _)| {
            let mut causes = causes.iter();
            causes.all(|&other| is_taken(*subset, other) != (other == cause))
        });
        let beside = others.map(|(_, others)| shrink(others, &with, floor, nominal));
        let [beside, low, high] = beside.unwrap_or_default();
        let interval = [(low - beside).min(0.0), (high - beside).max(0.0)];
        part(cause, [own, own + interval[0], own + interval[1]])
    });
    let mut parts: Vec<Attributed> = parts.collect();
    parts.sort_by(|a, b| b.shrink[0].total_cmp(&a.shrink[0]));
    parts
}

/// The effects of a fit, and the numbers that surely moved.
fn causes(problem: &Problem<'_>, fit: &Fit) -> Vec<Cause> {
    let is_said_anew = |number: &str| {
        let mut terms = fit.hypothesis.terms.iter();
        terms.any(|term| effects::of(term.kind.name).replaces() == Some(number))
    };
    let is_common = common_input_shift_s(problem.recording, &problem.priors, &fit.x).is_some();
    let has_moved = |place: &usize| {
        let name = &problem.priors[*place].name;
        let moved = fit.x[*place].abs();
        let is_sure = moved > LEAST_MOVE && moved > SURE * fit.std[*place];
        is_sure && (name != INPUT_TIME || is_common) && !is_said_anew(name)
    };
    let numbers = (0..problem.priors.len()).filter(has_moved);
    let effects = 0..fit.hypothesis.terms.len();
    numbers
        .map(Cause::Number)
        .chain(effects.map(Cause::Effect))
        .collect()
}

/// Squares of each window that are left with those causes that are `taken`, refitted; other numbers are as stated.
fn left_with(problem: &Problem<'_>, fit: &Fit, taken: impl Fn(Cause) -> bool) -> Vec<f64> {
    let is_common = common_input_shift_s(problem.recording, &problem.priors, &fit.x).is_some();
    let is_free = |place: &usize| {
        let is_time = problem.priors[*place].name == INPUT_TIME;
        is_time && !is_common || taken(Cause::Number(*place))
    };
    let kept: Vec<usize> = (0..problem.priors.len()).filter(is_free).collect();
    let numbers: Vec<_> = kept.iter().map(|&k| problem.priors[k].clone()).collect();
    let mut some = fit.clone();
    for place in (0..fit.hypothesis.terms.len()).rev() {
        if !taken(Cause::Effect(place)) {
            (some.hypothesis, some.x) = some.without(place);
        }
    }
    let own = some.x[problem.priors.len()..].iter().copied();
    let x = kept.iter().map(|&place| fit.x[place]).chain(own).collect();
    let held = problem.off_by(problem.modelling).with_numbers(&numbers);
    let held_fit = held.fit(&some.hypothesis, x, Part::All, ITERATIONS);
    held.window_squares(&held_fit, Part::All)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::{Hypothesis, priors};
    use crate::guess::start::linear;
    use crate::made;

    /// Shrink that is attributed to the number `viscous` and to a constant torque, out of 0.9 in all. The device has so much of either
    /// beyond its model, in N m s/rad and N m.
    fn accounted(viscous: f64, offset_nm: f64) -> [f64; 2] {
        let hidden = [
            format!("viscous:coefficient={viscous}"),
            format!("torque_offset:torque={offset_nm}"),
        ];
        let hidden: Vec<&str> = hidden.iter().map(String::as_str).collect();
        let mut recording = made::recording(&hidden);
        recording.tolerance.set("viscous", 1.0);
        let problem = Problem {
            priors: priors(&recording),
            ..made::problem(&recording)
        };
        let term = made::term("torque_offset", &[linear(0, 0.0, 1e-3)]);
        let hypothesis = Hypothesis { terms: vec![term] };
        let fit = problem.fit(&hypothesis, vec![0.0; 2], Part::All, 12);
        let nominal = problem.nominal_squares();
        let floor = problem.floor_squares(&fit);
        let parts = attributed(
            &problem,
            &fit,
            [0.9, 0.8, 1.0],
            [0.8, 1.0],
            &nominal,
            &floor,
        );
        [Cause::Number(0), Cause::Effect(0)].map(|cause| {
            let part = parts.iter().find(|part| part.cause == cause);
            part.unwrap_or_else(|| panic!("no {cause:?} in {parts:?}"))
                .shrink[0]
        })
    }

    #[test]
    fn a_number_that_moved_and_an_effect_share_what_they_close_together() {
        let [number, offset] = accounted(5.3e-4, 3e-4);
        assert!((number + offset - 0.9).abs() < 1e-9, "{number} {offset}");
        assert!(number > 2.0 * offset, "{number} {offset}");
        let [number, offset] = accounted(2.6e-4, 4e-3);
        assert!(offset > 2.0 * number, "{number} {offset}");
    }
}
