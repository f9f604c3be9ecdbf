//! Holds the sets of effects that are compared.

use super::scale;
use super::scored::{Scored, cheapest, is_within_error, log_rms, simplest};
use super::start::Start;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::objective::Objective;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::plausible::is_plausible;
use crate::select::Selection;
use rayon::prelude::*;

/// Number of sets that are scored on held-out windows: those of the lowest cost after a short fit.
const MOST_SCORED: usize = 12;
/// Number of sets of which simpler forms are tried.
const MOST_SIMPLIFIED: usize = 3;
/// Number of iterations of a short fit.
pub(super) const SHORT_ITERATIONS: usize = 3;
/// Number of sets that are scored again once the error scale is known from the best of them.
const MOST_SCORED_AGAIN: usize = 5;
/// Number of further sets that contain an implausible parameter value. They are reported as tried, and never chosen.
const MOST_IMPLAUSIBLE: usize = 2;
/// Largest ratio of the new error scale to the previous one at which sets are scored again.
const OTHER_SCALE: f64 = 0.7;

/// Sets of effects, as starts of fits.
pub(super) struct Pool {
    starts: Vec<Start>,
}

impl Pool {
    /// Returns the sets that a search fitted: its null, and every rival of each round. The fits of the search have `stated` coordinates for
    /// model parameters. Those of the pool have `freed` coordinates.
    pub(super) fn of_search(found: &Selection, stated: usize, freed: usize) -> Self {
        let widened = |fit: &Fit| {
            let mut x = fit.x[..stated].to_vec();
            x.resize(freed, 0.0);
            x.extend_from_slice(&fit.x[stated..]);
            Start {
                hypothesis: fit.hypothesis.clone(),
                x,
            }
        };
        let rounds = found.rounds[found.kept()..].iter().chain(&found.last);
        let rivals = rounds.flat_map(|round| {
            let rivals = round.rivals.iter().map(|rival| &rival.fit);
            core::iter::once(&round.so_far).chain(rivals)
        });
        let proposed = found.proposed.iter().map(|rival| &rival.fit);
        let starts = core::iter::once(found.known())
            .chain(rivals)
            .chain(proposed);
        Self {
            starts: starts.map(widened).collect(),
        }
    }

    /// Returns the set without effects. Its terms are the model parameters that are not stated.
    pub(super) fn null(&self) -> Start {
        self.starts[0].clone()
    }

    pub(super) fn extend(&mut self, starts: Vec<Start>) {
        self.starts.extend(starts);
    }

    pub(super) fn add(&mut self, fit: &Fit) {
        self.starts.push(Start {
            hypothesis: fit.hypothesis.clone(),
            x: fit.x.clone(),
        });
    }

    /// Fits all sets and computes their costs at the error scale of `problem`. If the residual of the best set is much smaller, the sets of
    /// lowest cost are scored again at that scale. Returns the problem at the final scale, and the sets.
    pub(super) fn scored_at_own_scale<'a>(self, problem: Problem<'a>) -> (Problem<'a>, ScoredPool) {
        let starts = shortlist(&problem, self.starts);
        let problem = problem.with_objective(Objective::RobustAndGap);
        let mut pool = ScoredPool::of(&problem, starts);
        let left = pool.least_left(&problem);
        if left >= OTHER_SCALE * problem.modelling {
            return (problem, pool);
        }
        let null = pool.null.clone();
        pool.keep_plausible(MOST_SCORED_AGAIN);
        let finer = problem.off_by(left);
        let again = core::iter::once(&null).chain(&pool.sets).map(|set| Start {
            hypothesis: set.fit.hypothesis.clone(),
            x: set.fit.x.clone(),
        });
        let again = ScoredPool::of(&finer, again.collect());
        (finer, again)
    }
}

/// Returns the null, and the sets of lowest cost after a short fit. There is one for each set of names.
fn shortlist(problem: &Problem<'_>, starts: Vec<Start>) -> Vec<Start> {
    let mut starts = starts.into_iter();
    let null = starts.next();
    let fits = starts.collect::<Vec<_>>().into_par_iter();
    let fits = fits.map(|start| short_fit(problem, &start.hypothesis, start.x));
    let mut fits: Vec<(f64, Fit)> = fits.collect();
    fits.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names = |fit: &Fit| fit.hypothesis.names();
    let mut kept: Vec<Fit> = Vec::new();
    let mut room = Room::of(MOST_SCORED);
    for (_, fit) in fits {
        let is_new = kept.iter().all(|other| names(other) != names(&fit));
        if is_new && room.takes(is_plausible(problem, &fit)) {
            kept.push(fit);
        }
    }
    let kept = kept.into_iter().map(|fit| Start {
        hypothesis: fit.hypothesis,
        x: fit.x,
    });
    null.into_iter().chain(kept).collect()
}

/// Returns simpler forms of `set`. Each has one effect less than the one before: the effect without which the cost is lowest. The last one
/// is the simplest whose cost is within one standard error of that of `best`.
fn simplified(problem: &Problem<'_>, set: &Scored, best: &Scored, kept: usize) -> Vec<Scored> {
    let mut all = Vec::new();
    let mut fit = set.fit.clone();
    while fit.hypothesis.terms.len() > kept + 1 {
        let places = kept..fit.hypothesis.terms.len();
        let fits = places.into_par_iter().map(|place| {
            let (hypothesis, x) = fit.without(place);
            short_fit(problem, &hypothesis, x)
        });
        let least = fits.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, less)) = least else {
            break;
        };
        let one = Scored::of(problem, &less.hypothesis, less.x);
        if !is_within_error(&one, best) {
            break;
        }
        fit = one.fit.clone();
        all.push(one);
    }
    all
}

/// Returns a fit with few iterations to all windows, and its cost.
fn short_fit(problem: &Problem<'_>, hypothesis: &Hypothesis, x: Vec<f64>) -> (f64, Fit) {
    let fit = problem.fit(hypothesis, x, Part::All, SHORT_ITERATIONS);
    let cost = fit.costs.level() + log_rms(&problem.window_squares(&fit, Part::All));
    (cost, fit)
}

/// Number of further sets that may be taken, plausible ones and others.
struct Room {
    plausible: usize,
    implausible: usize,
}

impl Room {
    fn of(plausible: usize) -> Self {
        Self {
            plausible,
            implausible: MOST_IMPLAUSIBLE,
        }
    }

    /// Takes one more set if there is room. Returns true if it was taken.
    fn takes(&mut self, is_plausible: bool) -> bool {
        let left = if is_plausible {
            &mut self.plausible
        } else {
            &mut self.implausible
        };
        let takes = *left > 0;
        *left -= usize::from(takes);
        takes
    }
}

/// Sets of effects, fitted and scored on held-out windows.
pub(super) struct ScoredPool {
    pub null: Scored,
    /// The sets, with the null among them and one for each set of names. They are in the order of increasing cost until further ones are
    /// added.
    pub sets: Vec<Scored>,
    /// Names of the sets from which each effect was left out in turn.
    reduced: Vec<Vec<&'static str>>,
    /// Names of the sets of which simpler forms were tried.
    simplified: Vec<Vec<&'static str>>,
}

impl ScoredPool {
    fn of(problem: &Problem<'_>, starts: Vec<Start>) -> Self {
        let scored = starts
            .into_par_iter()
            .map(|start| Scored::of(problem, &start.hypothesis, start.x));
        let mut scored: Vec<Scored> = scored.collect();
        let null = scored[0].clone();
        scored.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let mut sets: Vec<Scored> = Vec::new();
        for one in scored {
            if sets.iter().all(|set| set.names() != one.names()) {
                sets.push(one);
            }
        }
        Self {
            null,
            sets,
            reduced: Vec::new(),
            simplified: Vec::new(),
        }
    }

    /// Keeps the first `most` plausible sets and a few others.
    fn keep_plausible(&mut self, most: usize) {
        let mut room = Room::of(most);
        self.sets.retain(|set| room.takes(set.is_plausible));
    }

    /// Returns the error scale of the plausible set with the least residual on held-out windows, in position units.
    fn least_left(&self, problem: &Problem<'_>) -> f64 {
        let left = |set: &Scored| problem.rms(&set.squares);
        let plausible = self.sets.iter().filter(|set| set.is_plausible);
        let least = plausible
            .min_by(|a, b| left(a).total_cmp(&left(b)))
            .unwrap_or(&self.null);
        scale::beyond_noise_and_restart(problem, &least.fit)
    }

    /// Returns the simplest set within one standard error of the lowest cost, and the pool. Each effect of that set beyond the first `kept`
    /// was left out in turn.
    pub(super) fn without_needless(mut self, problem: &Problem<'_>, kept: usize) -> (Scored, Self) {
        loop {
            let Some(set) = simplest(&self.sets).cloned() else {
                return (self.null.clone(), self);
            };
            if self.reduced.contains(&set.names()) {
                return (set, self);
            }
            self.reduced.push(set.names());
            let places = kept..set.fit.hypothesis.terms.len();
            let reduced = places.into_par_iter().map(|place| {
                let (hypothesis, x) = set.fit.without(place);
                Scored::of(problem, &hypothesis, x)
            });
            let reduced: Vec<Scored> = reduced.collect();
            for one in reduced {
                self.add(one);
            }
        }
    }

    /// Returns the pool with simpler forms of the sets whose cost is within one standard error of the lowest one. At most
    /// [`MOST_SIMPLIFIED`] sets are simplified. The simplest set is not among them, because
    /// [`without_needless`](Self::without_needless) leaves out each of its effects in turn.
    pub(super) fn with_simpler(mut self, problem: &Problem<'_>, kept: usize) -> Self {
        let Some(best) = cheapest(&self.sets).cloned() else {
            return self;
        };
        let simplest = simplest(&self.sets).map(Scored::names);
        let within = self.sets.iter().filter(|set| {
            set.is_plausible && is_within_error(set, &best) && Some(set.names()) != simplest
        });
        let new = within.filter(|set| !self.simplified.contains(&set.names()));
        let new: Vec<&Scored> = new.take(MOST_SIMPLIFIED).collect();
        let names: Vec<_> = new.iter().map(|set| set.names()).collect();
        let simpler = new
            .into_par_iter()
            .map(|set| simplified(problem, set, &best, kept));
        let simpler: Vec<Vec<Scored>> = simpler.collect();
        self.simplified.extend(names);
        for one in simpler.into_iter().flatten() {
            self.add(one);
        }
        self
    }

    /// Returns the pool with further sets, each fitted and scored.
    pub(super) fn with(mut self, problem: &Problem<'_>, starts: Vec<Start>) -> Self {
        let scored = starts
            .into_par_iter()
            .map(|start| Scored::of(problem, &start.hypothesis, start.x));
        for one in scored.collect::<Vec<Scored>>() {
            self.add(one);
        }
        self
    }

    /// Adds a set. It replaces a set of the same names with a higher cost.
    fn add(&mut self, one: Scored) {
        match self.sets.iter_mut().find(|set| set.names() == one.names()) {
            Some(same) if same.cost() <= one.cost() => {}
            Some(same) => *same = one,
            None => self.sets.push(one),
        }
    }
}
