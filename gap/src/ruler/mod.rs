//! Compares all sets of effects by the same measure, for devices of which no single effect explains everything.
//!
//! Every set is fitted jointly with free model parameters. Its cost is the robust cost on held-out windows. All sets have the same error
//! scale, which is estimated from the residual of the best set. The simplest set within one standard error of the lowest cost is chosen.
//! Its effects are ordered by the share of the gap that each closes.
//!
//! There are three sources of sets: the search with the model parameters near their stated values, the missing torque, and all main
//! parameters estimated again.

mod agreement;
mod confounders;
mod numbers;
mod order;
mod pool;
mod proposed;
mod scale;
mod scored;
mod selection;
mod start;

use crate::effects::Identification;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::ExpectedLoss;
use crate::select::{Given, Search, Selection, next_effect};
use crate::stage::Stage;
use pool::{Pool, ScoredPool};
use scored::Scored;

/// Largest number of chosen sets of which an effect is exchanged for another.
const MOST_EXCHANGED: usize = 3;

/// Compares the effects that a search `found` with all sets that it fitted and with further sets. Returns `None` if the found effects
/// explain everything, or if there is no gap.
pub(crate) fn measured<'a>(
    problem: &Problem<'a>,
    found: &Selection,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<(Problem<'a>, Selection)> {
    if found.has_no_gap || found.is_explained(problem) {
        return None;
    }
    progress(Stage::Finalists);
    let freed = numbers::freed(problem, &given.excluded);
    let free = problem.off_by(problem.modelling).with_numbers(&freed);
    let mut pool = Pool::of_search(found, problem.priors.len(), freed.len());
    let scale = on_all_numbers(problem, &free, &mut pool, found, given, progress);
    let (free, pool) = pool.scored_at_own_scale(free.off_by(scale));
    let kept = found.known().hypothesis.terms.len();
    let search = Search {
        problem: &free,
        given,
        progress,
        expected: found.expected,
    };
    let (set, pool) = settled(&search, pool, kept);
    let selection = selection::of(&free, found, &set, &pool);
    Some((free, selection))
}

/// Returns the chosen set and the pool. Two kinds of sets are added to the pool until the chosen set stays the same: simpler forms of the
/// best sets, and the chosen set with one effect exchanged for another.
fn settled(search: &Search<'_>, mut pool: ScoredPool, kept: usize) -> (Scored, ScoredPool) {
    let mut exchanged = Vec::new();
    loop {
        let simpler = pool.with_simpler(search.problem, kept);
        let (set, reduced) = simpler.without_needless(search.problem, kept);
        if exchanged.contains(&set.names()) || exchanged.len() == MOST_EXCHANGED {
            return (set, reduced);
        }
        exchanged.push(set.names());
        let confounders = confounders::of(search, &set.fit, kept);
        pool = reduced.with(search.problem, confounders);
    }
}

/// Adds three kinds of sets to the pool: those that the missing torque proposes, the set of all main parameters, and effects on top of that
/// set. Returns the error scale at which the main parameters alone fit best, in position units. Returns the allowed model error if they
/// cannot be estimated.
fn on_all_numbers(
    stated: &Problem<'_>,
    free: &Problem<'_>,
    pool: &mut Pool,
    found: &Selection,
    given: &Given<'_>,
    progress: fn(Stage),
) -> f64 {
    let start = pool.null();
    let null = free.fit(&start.hypothesis, start.x, Part::All, 0);
    let search = Search {
        problem: free,
        given,
        progress,
        expected: found.expected,
    };
    pool.extend(proposed::proposed(&search, &null));
    let mut restating = numbers::restating(free.recording);
    let terms = &null.hypothesis.terms;
    restating.retain(|effect| terms.iter().all(|term| term.kind.name != effect.name()));
    let Some((numbers, scale)) = with_numbers_estimated(&search, &null, &restating) else {
        return free.modelling;
    };
    pool.add(&numbers);
    // If the found effects explain everything, or leave less than all main parameters do, wrong parameters are not the main cause.
    let left = |problem: &Problem<'_>, fit| problem.rms(&problem.window_squares(fit, Part::All));
    let best = found.best();
    if found.suffices(stated, best) || left(free, &numbers) >= left(stated, best) {
        return scale;
    }
    let scaled = free.off_by(scale);
    let search = Search {
        expected: ExpectedLoss::of(&scaled, &numbers).bounded(),
        problem: &scaled,
        ..search
    };
    for rival in next_effect(&search, &numbers)
        .iter()
        .flat_map(|round| &round.rivals)
    {
        pool.add(&rival.fit);
    }
    scale
}

/// Returns the fit of the model with each parameter that is not stated estimated as a term. Returns `None` if all are stated.
pub(crate) fn with_unstated(
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<Fit> {
    let unstated = numbers::unstated(problem.recording);
    if unstated.is_empty() {
        return None;
    }
    let bare = Hypothesis { terms: Vec::new() };
    let x = vec![0.0; bare.dimensions(&problem.priors)];
    let null = problem.fit(&bare, x, Part::All, 0);
    let search = Search {
        problem,
        given,
        progress,
        expected: ExpectedLoss::of(problem, &null).bounded(),
    };
    let (fit, _) = with_numbers_estimated(&search, &null, &unstated)?;
    Some(problem.fit(&fit.hypothesis, fit.x, Part::All, scale::ITERATIONS))
}

/// Returns a fit with some model parameters estimated again, each as the term of an effect. It also returns the error scale at which that
/// fit is best.
fn with_numbers_estimated(
    search: &Search<'_>,
    null: &Fit,
    restating: &[&'static dyn Identification],
) -> Option<(Fit, f64)> {
    let starts = numbers::starts(search, null, restating);
    let fits = starts.into_iter().map(|terms| {
        let mut hypothesis = null.hypothesis.clone();
        hypothesis.terms.extend(terms);
        let mut x = null.x.clone();
        x.resize(hypothesis.dimensions(&search.problem.priors), 0.0);
        scale::annealed(search.problem, &hypothesis, x)
    });
    fits.min_by(|a, b| a.1.total_cmp(&b.1))
}
