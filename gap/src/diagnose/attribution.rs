//! Divides the shrink of the gap among the parts of a corrected model: its effects, and the model parameters that moved.

use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::{INPUT_TIME, common_input_shift_s};
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::shapley;
use crate::shrink::{part_on_another, shrink};
use rayon::prelude::*;

const ITERATIONS: usize = 6;
/// Least move of a parameter, in standard deviations of its estimate.
const LEAST_SIGNIFICANCE: f64 = 2.0;
/// Least move of a parameter, in standard deviations of its tolerance.
const LEAST_MOVE: f64 = 0.01;

/// A part of a corrected model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A model parameter that moved, by its index among the prior parameters.
    Number(usize),
    /// An effect, by its index in the fit.
    Effect(usize),
}

/// The shrink that is attributed to a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attributed {
    pub cause: Cause,
    /// Share of the shrink of the whole model, with its 95 % interval on another recording.
    pub shrink: [f64; 3],
}

/// Divides the `total` shrink of a fit, with its 95 % interval, among the effects and the parameters that moved. The part that closes
/// most comes first. `elsewhere` is the 95 % interval of the total on another recording.
///
/// Each part gets its Shapley share: subsets of the parts are refitted, and the shrink that several parts could cause is divided among
/// them. `nominal` and `floor` are sums of squared residuals by window, in position units squared.
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
    let is_included = |subset: u32, cause: Cause| {
        let place = causes.iter().position(|other| *other == cause);
        place.is_some_and(|place| subset >> place & 1 == 1)
    };
    let subsets = shapley::subsets(causes.len()).into_par_iter();
    let refits = subsets.map(|subset| {
        let squares = window_squares_with(problem, fit, |cause| is_included(subset, cause));
        (subset, squares)
    });
    let refits: Vec<(u32, Vec<f64>)> = refits.collect();
    let rms = refits
        .iter()
        .map(|(subset, squares)| (*subset, problem.rms(squares)));
    let shares = shapley::shares(causes.len(), &rms.collect::<Vec<_>>());
    let positive = shares.iter().map(|share| share.of_all.max(0.0));
    let sum = positive.sum::<f64>().max(f64::MIN_POSITIVE);
    let with = problem.window_squares(fit, Part::All);
    let parts = causes.iter().zip(&shares).map(|(&cause, share)| {
        let own = total[0] * share.of_all.max(0.0) / sum;
        let others = refits.iter().find(|(subset, _)| {
            let mut causes = causes.iter();
            causes.all(|&other| is_included(*subset, other) != (other == cause))
        });
        let own_shrink = others.map(|(_, others)| shrink(others, &with, floor, nominal));
        let [own_shrink, low, high] = own_shrink.unwrap_or_default();
        let interval = [(low - own_shrink).min(0.0), (high - own_shrink).max(0.0)];
        part(cause, [own, own + interval[0], own + interval[1]])
    });
    let mut parts: Vec<Attributed> = parts.collect();
    parts.sort_by(|a, b| b.shrink[0].total_cmp(&a.shrink[0]));
    parts
}

/// The effects of a fit, and the parameters that moved significantly.
fn causes(problem: &Problem<'_>, fit: &Fit) -> Vec<Cause> {
    let is_replaced = |number: &str| {
        let mut terms = fit.hypothesis.terms.iter();
        terms.any(|term| effects::of(term.kind.name).replaces() == Some(number))
    };
    let is_common = common_input_shift_s(problem.recording, &problem.priors, &fit.x).is_some();
    let has_moved = |place: &usize| {
        let name = &problem.priors[*place].name;
        let moved = fit.x[*place].abs();
        let is_sure = moved > LEAST_MOVE && moved > LEAST_SIGNIFICANCE * fit.std[*place];
        is_sure && (name != INPUT_TIME || is_common) && !is_replaced(name)
    };
    let numbers = (0..problem.priors.len()).filter(has_moved);
    let effects = 0..fit.hypothesis.terms.len();
    numbers
        .map(Cause::Number)
        .chain(effects.map(Cause::Effect))
        .collect()
}

/// Sum of squared residuals of each window in a fit of the `included` causes. The other model parameters have their stated values.
fn window_squares_with(
    problem: &Problem<'_>,
    fit: &Fit,
    included: impl Fn(Cause) -> bool,
) -> Vec<f64> {
    let is_common = common_input_shift_s(problem.recording, &problem.priors, &fit.x).is_some();
    let is_free = |place: &usize| {
        let is_time = problem.priors[*place].name == INPUT_TIME;
        is_time && !is_common || included(Cause::Number(*place))
    };
    let kept: Vec<usize> = (0..problem.priors.len()).filter(is_free).collect();
    let numbers: Vec<_> = kept.iter().map(|&k| problem.priors[k].clone()).collect();
    let mut some = fit.clone();
    for place in (0..fit.hypothesis.terms.len()).rev() {
        if !included(Cause::Effect(place)) {
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

    /// Shrink that is attributed to the parameter `viscous` and to a constant torque, of 0.9 in all. The device has these additional
    /// values, in N m s/rad and N m.
    fn attributed_shrinks(viscous: f64, offset_nm: f64) -> [f64; 2] {
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
    fn a_moved_parameter_and_an_effect_share_the_common_shrink() {
        let [number, offset] = attributed_shrinks(5.3e-4, 3e-4);
        assert!((number + offset - 0.9).abs() < 1e-9, "{number} {offset}");
        assert!(number > 2.0 * offset, "{number} {offset}");
        let [number, offset] = attributed_shrinks(2.6e-4, 4e-3);
        assert!(offset > 2.0 * number, "{number} {offset}");
    }
}
