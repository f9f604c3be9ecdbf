//! The order of the effects of a set: by what each closes.

use super::scored::Scored;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use rayon::prelude::*;

const ITERATIONS: usize = 5;
/// Effects of which every subset is fitted; of more, each is taken alone and left out.
const MOST_SUBSETS: usize = 4;
/// Share of what the whole set closes that an effect closes alone at least, where it closes less: two that cancel close nothing
/// alone, and one of them comes first all the same.
const LEAST_ALONE: f64 = 0.05;

/// Places of the effects of a set beyond the first `kept`, the one that closes most of the gap first: by its Shapley share of what
/// the set closes (Shapley, Contributions to the Theory of Games 2, 1953) times what it closes alone.
pub(super) fn order(problem: &Problem<'_>, set: &Scored, kept: usize) -> Vec<usize> {
    let count = set.fit.hypothesis.terms.len() - kept;
    if count < 2 {
        return (0..count).collect();
    }
    let all = (1u32 << count) - 1;
    let subsets: Vec<u32> = (0..=all)
        .filter(|subset| {
            let size = subset.count_ones() as usize;
            count <= MOST_SUBSETS || size <= 1 || size >= count - 1
        })
        .collect();
    let left = |subset: u32| -> f64 {
        let fit = subset_fit(problem, &set.fit, kept, |place| subset >> place & 1 == 1);
        problem.rms(&problem.window_squares(&fit, Part::All))
    };
    let left: Vec<(u32, f64)> = subsets.into_par_iter().map(|s| (s, left(s))).collect();
    let closed = |subset: u32| {
        let of = |wanted| left.iter().find(|(s, _)| *s == wanted).map(|(_, rms)| *rms);
        Some(of(0)? - of(subset)?)
    };
    let whole = closed(all).unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let worth = |place: usize| {
        let own = 1 << place;
        let mut sum = 0.0;
        let mut weights = 0.0;
        for (subset, _) in left.iter().filter(|(s, _)| s & own == 0) {
            let (Some(with), Some(without)) = (closed(subset | own), closed(*subset)) else {
                continue;
            };
            let weight = shapley_weight(subset.count_ones() as usize, count);
            sum += weight * (with - without);
            weights += weight;
        }
        let share = sum / weights.max(f64::MIN_POSITIVE) / whole;
        let alone = (closed(own).unwrap_or(0.0) / whole).max(LEAST_ALONE);
        share * alone
    };
    let worths: Vec<f64> = (0..count).map(worth).collect();
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_by(|&a, &b| worths[b].total_cmp(&worths[a]));
    places
}

/// `size! (count − size − 1)! / count!`.
fn shapley_weight(size: usize, count: usize) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    factorial(size) * factorial(count - size - 1) / factorial(count)
}

/// The set with its first `kept` effects and those others that are `taken`, refitted.
pub(super) fn subset_fit(
    problem: &Problem<'_>,
    set: &Fit,
    kept: usize,
    taken: impl Fn(usize) -> bool,
) -> Fit {
    let count = set.hypothesis.terms.len();
    let mut fit = set.clone();
    let mut is_whole = true;
    for place in (kept..count).rev() {
        if !taken(place - kept) {
            (fit.hypothesis, fit.x) = fit.without(place);
            is_whole = false;
        }
    }
    if is_whole {
        return fit;
    }
    problem.fit(&fit.hypothesis, fit.x, Part::All, ITERATIONS)
}
