//! One measure for all sets of effects, for devices of which no single effect explains everything.
//!
//! Every set is fitted jointly, with the model's numbers free, and costed on windows that its fit has not seen, at one error scale
//! that is estimated from what the best set leaves. The simplest set within one standard error of the best is taken; its effects are
//! ordered by what each closes. Sets come from the search with the numbers as stated, and from one that begins by saying all main
//! numbers anew.

mod agreement;
mod numbers;
mod order;
mod pool;
mod scale;
mod scored;
mod selection;

use crate::fit::hypothesis::Hypothesis;
use crate::fit::problem::Problem;
use crate::fit::part::Part;
use crate::floor::Perfect;
use crate::select::{Given, Search, Selection};
use crate::stage::Stage;
use pool::Pool;

/// Effects that are looked for one after the other on top of all main numbers.
const MOST_ON_NUMBERS: usize = 2;

/// Measures what a search `found` against all sets that it met and against those beyond the model's numbers. None where what was
/// found leaves nothing to explain: the device is as exact as its model.
pub(crate) fn measured<'a>(
    problem: &Problem<'a>,
    found: &Selection,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<(Problem<'a>, Selection)> {
    let is_explained = !found.rounds.is_empty() && found.suffices(problem, found.fit());
    if found.quiet || found.given || is_explained {
        return None;
    }
    progress(Stage::Finalists);
    let freed = numbers::freed(problem);
    let free = problem.off_by(problem.modelling).with_numbers(&freed);
    let mut pool = Pool::of_search(found, problem.nudges.len(), freed.len());
    let scale = on_all_numbers(&free, &mut pool, found, given, progress);
    let (free, pool) = pool.scored_at_own_scale(free.off_by(scale));
    let (set, pool) = pool.without_needless(&free, found.null.hypothesis.terms.len());
    let selection = selection::of(&free, found, &set, &pool);
    Some((free, selection))
}

/// Adds the sets that are found on top of all main numbers; returns the error scale at which these alone are fitted best.
fn on_all_numbers(
    free: &Problem<'_>,
    pool: &mut Pool,
    found: &Selection,
    given: &Given<'_>,
    progress: fn(Stage),
) -> f64 {
    let start = pool.null();
    let null = free.fit(&start.hypothesis, start.x, Part::All, 0);
    let search = |problem, perfect| Search {
        problem,
        given,
        progress,
        perfect,
    };
    let is_linear = given.excluded.contains(&numbers::PULLS[0]);
    let names = numbers::names(free.recording, is_linear);
    let starts = numbers::restated(&search(free, found.perfect), &null, &names);
    let fits = starts.into_iter().map(|terms| {
        let mut hypothesis = null.hypothesis.clone();
        hypothesis.terms.extend(terms);
        let x = vec![0.0; hypothesis.dimensions(&free.nudges)];
        scale::annealed(free, &hypothesis, x)
    });
    let Some((numbers, scale)) = fits.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return free.modelling;
    };
    let scaled = free.off_by(scale);
    let perfect = Perfect::of(&scaled, &numbers).bounded();
    let search = search(&scaled, perfect);
    pool.add(&numbers);
    let mut known = numbers;
    for _ in 0..MOST_ON_NUMBERS {
        let Some(round) = search.round(&known, &[], 0.0) else {
            break;
        };
        for rival in &round.rivals {
            pool.add(&rival.fit);
        }
        if !round.place.earned {
            break;
        }
        known = round.so_far;
    }
    scale
}

/// A place to fit from.
#[derive(Clone, Debug)]
struct Start {
    hypothesis: Hypothesis,
    x: Vec<f64>,
}
