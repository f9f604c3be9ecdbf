//! A set of effects and its cost on held-out windows.

use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::mean_and_error;
use crate::plausible::Implausible;

const ITERATIONS: usize = 5;
/// Usual errors by which a number that is stated as exact may move without counting as an effect.
const USUAL: f64 = 1.0;

/// A set of effects, fitted jointly.
#[derive(Clone, Debug)]
pub(super) struct Scored {
    /// To all windows.
    pub fit: Fit,
    /// Robust cost of each window under the fit to the half of the windows that it is not in.
    pub unseen: Vec<f64>,
    /// Squared residual of each window, likewise, in units of position squared.
    pub squares: Vec<f64>,
    /// Numbers of the model that are stated as exact, and moved farther than such numbers usually are off.
    pub moved: usize,
    /// True if no number of its effects is one that no device has.
    pub is_plausible: bool,
}

impl Scored {
    pub(super) fn of(problem: &Problem<'_>, hypothesis: &Hypothesis, x: Vec<f64>) -> Self {
        Self::of_fit(problem, problem.fit(hypothesis, x, Part::All, ITERATIONS))
    }

    /// Of a fit to all windows.
    pub(super) fn of_fit(problem: &Problem<'_>, fit: Fit) -> Self {
        let halves = problem.halves(&fit);
        let unseen = Problem::held_out_by(&halves, |fit, half| {
            problem.costs(&fit.hypothesis, &fit.x, half).per_sample
        });
        let squares = Problem::held_out_by(&halves, |fit, half| problem.window_squares(fit, half));
        let moves = problem.priors.iter().zip(fit.moves());
        let moved = moves.filter(|(number, z)| !number.is_stated && z.abs() > USUAL);
        Self {
            moved: moved.count(),
            is_plausible: Implausible::has_none(problem, &fit),
            fit,
            unseen: unseen.into_iter().map(f64::ln_1p).collect(),
            squares,
        }
    }

    /// Names of its effects, sorted.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.fit.hypothesis.names()
    }

    /// Effects and numbers that moved as such, then free numbers of effects.
    pub(super) fn complexity(&self) -> (usize, usize) {
        let hypothesis = &self.fit.hypothesis;
        (hypothesis.terms.len() + self.moved, hypothesis.free())
    }

    /// Mean cost of a window, with the cost of moving the numbers of the model.
    pub(super) fn cost(&self) -> f64 {
        let sum: f64 = self.unseen.iter().sum();
        (sum + self.fit.costs.prior) / self.unseen.len().max(1) as f64
    }

    /// By how much more a window costs than with `other` on average, and the standard error of that.
    pub(super) fn excess_over(&self, other: &Self) -> [f64; 2] {
        let pairs = self.unseen.iter().zip(&other.unseen);
        let differences: Vec<f64> = pairs.map(|(own, its)| own - its).collect();
        let (_, error) = mean_and_error(&differences);
        [self.cost() - other.cost(), error]
    }
}

/// The simplest of those that are plausible and whose cost is within one standard error of the least: fewest effects, then fewest
/// free numbers, then the lowest cost.
pub(super) fn simplest(all: &[Scored]) -> Option<&Scored> {
    let plausible = || all.iter().filter(|scored| scored.is_plausible);
    let best = plausible().min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
    let within = plausible().filter(|scored| is_within_error(scored, best));
    within.min_by(|a, b| {
        let by_complexity = a.complexity().cmp(&b.complexity());
        by_complexity.then(a.cost().total_cmp(&b.cost()))
    })
}

/// True if a set of effects costs no more than one standard error beyond another.
pub(super) fn is_within_error(one: &Scored, other: &Scored) -> bool {
    let [excess, error] = one.excess_over(other);
    excess <= error
}
