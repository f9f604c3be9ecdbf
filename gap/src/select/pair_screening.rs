//! Finds the pairs of effects with the lowest estimated cost together. Each effect alone may gain little.

use super::rival::{Rival, extended};
use super::screening::{STARTS, soon};
use super::screening_set::{FIRST_ITERATIONS, MANY_ITERATIONS, ScreeningSet, sorted};
use super::search::Search;
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::linearization::EffectModel;
use crate::fit::part::Part;
use crate::term::Term;
use rayon::prelude::*;

/// Number of pairs that are fitted: those with the lowest estimated cost.
const PROPOSED: usize = 12;
/// Number of pairs whose fits are continued.
const PROPOSED_KEPT: usize = 4;
/// Largest number of these pairs that contain the same effect.
const MOST_TIMES: usize = 3;

/// Returns pairs of effects fitted to the `chosen` windows. They have the lowest estimated cost on these windows, or over a quarter of the
/// horizon. Over a shorter time the change of the motion is closer to proportional to the magnitude of an effect.
pub(super) fn screened_pairs(
    search: &Search<'_>,
    null: &Fit,
    chosen: &[bool],
    alone: &[Rival],
) -> Vec<Rival> {
    let field = ScreeningSet::new(search.problem, null, chosen);
    // An effect bound to an instant is left out, because it can fit any residual beside another effect.
    let alone = alone.iter().filter(|rival| !rival.is_event());
    let alone = alone.filter_map(|rival| rival.fit.last_term());
    let mut starts: Vec<Term> = alone.collect();
    let others = search.tried(null, &[]).into_iter().filter(|candidate| {
        let effect = candidate.effect;
        !effect.is_local() && !effect.landscape().is_scanned()
    });
    starts.extend(others.flat_map(|candidate| field.promising(&candidate.starts, STARTS)));
    let mut proposed = pairs(&field, &starts);
    let soon = soon(search, null).map_or(Vec::new(), |soon| pairs(&soon, &starts));
    let soon = soon.into_par_iter();
    proposed.par_extend(soon.map(|fit| fit_both(&field, &fit.hypothesis, fit.x, MANY_ITERATIONS)));
    let rivals = proposed.into_iter().filter_map(|fit| {
        let name = fit.last_term()?.kind.name;
        Some(Rival { name, fit })
    });
    rivals.collect()
}

/// Fits the pairs with the lowest estimated cost, and returns the best fits.
fn pairs(field: &ScreeningSet<'_>, starts: &[Term]) -> Vec<Fit> {
    let pairs = promising_pairs(field, starts, PROPOSED).into_par_iter();
    let short = pairs.map(|pair| short_fit_of_both(field, pair));
    let mut short = sorted(short.collect());
    short.truncate(PROPOSED_KEPT);
    let fits = short.into_par_iter();
    fits.map(|fit| fit_both(field, &fit.hypothesis, fit.x, MANY_ITERATIONS))
        .collect()
}

/// Fits two effects with few iterations from their starts.
fn short_fit_of_both(field: &ScreeningSet<'_>, pair: [Term; 2]) -> Fit {
    let (hypothesis, x) = extended(field.known, &pair);
    fit_both(field, &hypothesis, x, FIRST_ITERATIONS)
}

/// Fits two effects from the coordinates `x`.
fn fit_both(
    field: &ScreeningSet<'_>,
    hypothesis: &Hypothesis,
    x: Vec<f64>,
    iterations: usize,
) -> Fit {
    let part = Part::Chosen(&field.chosen);
    field.problem.fit(hypothesis, x, part, iterations)
}

/// Returns the `kept` pairs of effects with the lowest estimated cost. The estimate is linear at the starts of the effects. An effect that
/// has a low cost with any other effect takes part in a limited number of these pairs.
fn promising_pairs(field: &ScreeningSet<'_>, starts: &[Term], kept: usize) -> Vec<[Term; 2]> {
    let part = Part::Chosen(&field.chosen);
    let effect_model = |start: &Term| {
        let (hypothesis, x) = extended(field.known, [start]);
        field
            .linearization
            .effect_model(field.problem, &hypothesis, &x, part)
    };
    let models: Vec<EffectModel> = starts.par_iter().map(effect_model).collect();
    let pairs = (0..starts.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    // An effect and its special case do not form a pair.
    let is_pair = |[i, j]: &[usize; 2]| {
        let [a, b] = [i, j].map(|i: &usize| starts[*i].kind.name);
        a != b && !effects::of(a).contains(b) && !effects::of(b).contains(a)
    };
    let pairs: Vec<[usize; 2]> = pairs.filter(is_pair).collect();
    let priors = field.problem.priors.len();
    let linear_cost = |pair: [usize; 2]| {
        let both = pair.map(|i| &models[i]);
        (field.linearization.linear_cost_of_both(priors, both), pair)
    };
    let costs = pairs.into_par_iter().map(linear_cost);
    let mut costs: Vec<(f64, [usize; 2])> = costs.filter(|p| p.0.is_finite()).collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names: Vec<&str> = starts.iter().map(|start| start.kind.name).collect();
    let best = spread(costs.into_iter().map(|(_, pair)| pair), &names, kept).into_iter();
    best.map(|pair| pair.map(|i| starts[i].clone())).collect()
}

/// Returns the first `kept` of the pairs. Each has a different set of names, and the number of pairs with the same name is limited.
fn spread(pairs: impl Iterator<Item = [usize; 2]>, names: &[&str], kept: usize) -> Vec<[usize; 2]> {
    let mut taken: Vec<[usize; 2]> = Vec::new();
    for pair in pairs {
        let [a, b] = pair.map(|i| names[i]);
        let of_taken = || taken.iter().map(|other| other.map(|i| names[i]));
        let times = |name| of_taken().filter(|other| other.contains(&name)).count();
        let is_new = of_taken().all(|other| other != [a, b] && other != [b, a]);
        if is_new && times(a).max(times(b)) < MOST_TIMES {
            taken.push(pair);
        }
        if taken.len() == kept {
            break;
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::select::screening::{screened, screening_windows};
    use crate::select::search;

    #[test]
    fn pairs_have_different_names_and_no_name_is_in_all_of_them() {
        let names = ["cogging", "cogging", "lag", "spring", "viscous", "delay"];
        let pairs = [[0, 2], [1, 2], [0, 3], [1, 4], [0, 5], [2, 3], [4, 5]];
        let taken = spread(pairs.into_iter(), &names, 5);
        assert_eq!(taken, [[0, 2], [0, 3], [1, 4], [2, 3], [4, 5]]);
        assert_eq!(spread(pairs.into_iter(), &names, 2), [[0, 2], [0, 3]]);
    }

    #[test]
    fn effects_that_compensate_each_other_are_proposed_together() {
        // Viscous friction reduces the motion. The sensor gain increases its reading.
        let hidden = ["sensor_gain:gain=1.3", "viscous:coefficient=0.002"];
        let recording = made::recording(&hidden);
        search::on(&recording, |search, null| {
            let chosen = screening_windows(search, null);
            let alone = screened(search, null, &chosen, &[]);
            let proposed = screened_pairs(search, null, &chosen, &alone).into_iter();
            let best = &sorted(proposed.map(|rival| rival.fit).collect())[0];
            let found = best.hypothesis.parts(&best.x);
            let mut found: Vec<(&str, f64)> = found
                .map(|(term, own)| (term.kind.name, term.at(own)[0]))
                .collect();
            found.sort_by(|a, b| a.0.cmp(b.0));
            let [(gain, times), (drag, coefficient)] = found[..] else {
                panic!("{found:?}");
            };
            assert_eq!([gain, drag], ["sensor_gain", "viscous"], "{found:?}");
            assert!((times / 1.3 - 1.0).abs() < 0.02, "{found:?}");
            assert!((coefficient / 0.002 - 1.0).abs() < 0.05, "{found:?}");
        });
    }
}
