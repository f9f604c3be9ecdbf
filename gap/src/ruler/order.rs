//! Orders the effects of a set by the share of the gap that each closes.

use super::scored::Scored;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::shapley;
use rayon::prelude::*;

const ITERATIONS: usize = 5;

/// Returns the places of the effects of a set beyond the first `kept`. The effect that closes the largest share of the gap is the first.
pub(super) fn order(problem: &Problem<'_>, set: &Scored, kept: usize) -> Vec<usize> {
    let count = set.fit.hypothesis.terms.len() - kept;
    let mut places: Vec<usize> = (0..count).collect();
    if count < 2 {
        return places;
    }
    let left = shapley::subsets(count).into_par_iter().map(|subset| {
        let fit = subset_fit(problem, &set.fit, kept, |place| subset >> place & 1 == 1);
        (
            subset,
            problem.rms(&problem.window_squares(&fit, Part::All)),
        )
    });
    let shares = shapley::shares(count, &left.collect::<Vec<_>>());
    places.sort_by(|&a, &b| shares[b].rank().total_cmp(&shares[a].rank()));
    places
}

/// Returns the set with its first `kept` effects and the others that are `taken`, fitted again.
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
