//! Compares starts on a few windows, on top of the model so far.

use super::excess::level;
use super::rival::extended;
use crate::fit::Fit;
use crate::fit::linearization::Linearization;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::term::Term;
use rayon::prelude::*;
use std::borrow::Cow;

/// Number of iterations of the first fit of a start.
pub(super) const FIRST_ITERATIONS: usize = 2;
/// Number of iterations of a continued fit of a pair, or of an effect of which several starts are continued.
pub(super) const MANY_ITERATIONS: usize = 6;

/// The windows on which starts are compared, and the model so far with its linearization there.
pub(super) struct ScreeningSet<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) known: &'a Fit,
    pub(super) chosen: Cow<'a, [bool]>,
    pub(super) linearization: Linearization,
}

impl<'a> ScreeningSet<'a> {
    pub(super) fn new(
        problem: &'a Problem<'a>,
        known: &'a Fit,
        chosen: impl Into<Cow<'a, [bool]>>,
    ) -> Self {
        let chosen = chosen.into();
        Self {
            linearization: problem.linearization(known, Part::Chosen(&chosen)),
            problem,
            known,
            chosen,
        }
    }

    /// Returns the fit of the model so far with one more effect, from a start.
    pub(super) fn fit(&self, start: &Term, iterations: usize) -> Fit {
        let (hypothesis, x) = extended(self.known, [start]);
        let linearization = Some(&self.linearization);
        let part = Part::Chosen(&self.chosen);
        self.problem
            .fit_on(linearization, &hypothesis, x, part, iterations)
    }

    /// Returns the cost per window at a start, without a fit.
    pub(super) fn cost(&self, start: &Term) -> f64 {
        level(&self.fit(start, 0))
    }

    /// Returns the cost per window of a fit on the chosen windows.
    pub(super) fn cost_of(&self, fit: &Fit) -> f64 {
        let part = Part::Chosen(&self.chosen);
        self.problem.costs(&fit.hypothesis, &fit.x, part).level()
    }

    /// Returns the `kept` starts with the lowest estimated cost. The estimate is linear.
    pub(super) fn promising(&self, starts: &[Term], kept: usize) -> Vec<Term> {
        if starts.len() <= kept {
            return starts.to_vec();
        }
        let part = Part::Chosen(&self.chosen);
        let promise = |start: &Term| {
            let (hypothesis, x) = extended(self.known, [start]);
            self.linearization
                .linear_cost(self.problem, &hypothesis, &x, part)
        };
        lowest(starts.par_iter().map(|s| (promise(s), s)).collect(), kept)
    }

    /// Returns the `kept` fits of lowest cost among short fits from `starts`.
    pub(super) fn short_fits(&self, starts: &[Term], kept: usize) -> Vec<Fit> {
        let short_fit = |start: &Term| self.fit(start, FIRST_ITERATIONS);
        let mut fits = sorted(starts.par_iter().map(short_fit).collect());
        fits.truncate(kept);
        fits
    }
}

/// Returns the fits in the order of increasing cost.
pub(super) fn sorted(mut fits: Vec<Fit>) -> Vec<Fit> {
    fits.sort_by(|a, b| level(a).total_cmp(&level(b)));
    fits
}

/// Returns the `kept` starts of lowest cost.
pub(super) fn lowest(mut costs: Vec<(f64, &Term)>, kept: usize) -> Vec<Term> {
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    costs.truncate(kept);
    costs.into_iter().map(|(_, start)| start.clone()).collect()
}
