//! Scores a set of effects by its cost on held-out windows.

use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::mean_and_error;
use crate::plausible::is_plausible;

/// Number of iterations of the joint fit of a set.
const ITERATIONS: usize = 5;

/// A set of effects, fitted jointly.
#[derive(Clone, Debug)]
pub(super) struct Scored {
    /// The fit to all windows.
    pub fit: Fit,
    /// Robust cost of each window under the fit to the half of the windows that does not contain it.
    pub unseen: Vec<f64>,
    /// Sum of squared residuals of each window under the same fit, in position units squared.
    pub squares: Vec<f64>,
    /// Number of model parameters that deviate so far that they count as effects.
    pub moved: usize,
    /// True if no effect has an implausible parameter value, and each acts as its name says.
    pub is_plausible: bool,
}

impl Scored {
    pub(super) fn of(problem: &Problem<'_>, hypothesis: &Hypothesis, x: Vec<f64>) -> Self {
        Self::of_fit(problem, problem.fit(hypothesis, x, Part::All, ITERATIONS))
    }

    /// Scores a fit to all windows.
    pub(super) fn of_fit(problem: &Problem<'_>, fit: Fit) -> Self {
        let halves = problem.halves(&fit);
        let unseen = Problem::held_out_by(&halves, |fit, half| {
            problem.costs(&fit.hypothesis, &fit.x, half).per_sample
        });
        let squares = Problem::held_out_by(&halves, |fit, half| problem.window_squares(fit, half));
        let moves = problem.priors.iter().zip(fit.moves());
        let moved = moves.filter(|(number, z)| number.counts_as_effect(**z));
        Self {
            moved: moved.count(),
            is_plausible: is_plausible(problem, &fit),
            fit,
            unseen: unseen.into_iter().map(f64::ln_1p).collect(),
            squares,
        }
    }

    /// Returns the names of its effects, sorted.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.fit.hypothesis.names()
    }

    /// Returns the number of effects, with the model parameters that count as effects, and the number of free parameters of the effects.
    pub(super) fn complexity(&self) -> (usize, usize) {
        let hypothesis = &self.fit.hypothesis;
        (hypothesis.terms.len() + self.moved, hypothesis.free())
    }

    /// Returns the mean robust cost of a held-out window, plus the prior cost per window, plus the logarithm of the rms residual. The robust
    /// cost alone says little about the gap where the residual is far above the noise, because it barely counts a window that is predicted
    /// badly. The rms residual alone follows a few such windows.
    pub(super) fn cost(&self) -> f64 {
        OnWindows::of(self, &self.all()).cost
    }

    /// Returns the difference of the cost from that of `other`, and its standard error over the windows.
    pub(super) fn excess_over(&self, other: &Self) -> [f64; 2] {
        let [own, its] = [self, other].map(|set| OnWindows::of(set, &set.all()));
        own.excess_over(&its)
    }

    /// Returns the indices of all windows.
    fn all(&self) -> Vec<usize> {
        (0..self.unseen.len()).collect()
    }
}

/// A set on some windows, each of which may be taken several times.
struct OnWindows {
    cost: f64,
    /// Change of the cost with the weight of each window, times the number of windows.
    influences: Vec<f64>,
}

impl OnWindows {
    fn of(set: &Scored, windows: &[usize]) -> Self {
        let count = windows.len().max(1) as f64;
        let squares: Vec<f64> = windows.iter().map(|&w| set.squares[w]).collect();
        let per_square = 0.5 * count / squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let robust: f64 = windows.iter().map(|&w| set.unseen[w]).sum();
        let prior = set.fit.costs.prior / set.unseen.len().max(1) as f64;
        let pairs = windows.iter().zip(&squares);
        Self {
            cost: robust / count + prior + log_rms(&squares),
            influences: pairs
                .map(|(&w, square)| set.unseen[w] + per_square * square)
                .collect(),
        }
    }

    fn excess_over(&self, other: &Self) -> [f64; 2] {
        let pairs = self.influences.iter().zip(&other.influences);
        let differences: Vec<f64> = pairs.map(|(own, its)| own - its).collect();
        let (_, error) = mean_and_error(&differences);
        [self.cost - other.cost, error]
    }
}

/// Returns the logarithm of the root of the sum of `squares`.
pub(super) fn log_rms(squares: &[f64]) -> f64 {
    0.5 * squares.iter().sum::<f64>().max(f64::MIN_POSITIVE).ln()
}

/// Returns the simplest of the plausible sets whose cost is within one standard error of the lowest cost. It has the fewest effects, then
/// the fewest free parameters, then the lowest cost. Returns `None` if no set is plausible.
pub(super) fn simplest(all: &[Scored]) -> Option<&Scored> {
    simplest_on(all, &all.first()?.all())
}

/// Returns the simplest set as [`simplest`] does, with the costs on some windows.
pub(super) fn simplest_on<'a>(all: &'a [Scored], windows: &[usize]) -> Option<&'a Scored> {
    let plausible = all.iter().filter(|scored| scored.is_plausible);
    let plausible: Vec<(&Scored, OnWindows)> = plausible
        .map(|scored| (scored, OnWindows::of(scored, windows)))
        .collect();
    let (_, best) = plausible
        .iter()
        .min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))?;
    let within = plausible.iter().filter(|(_, costs)| {
        let [excess, error] = costs.excess_over(best);
        excess <= error
    });
    let simplest = within.min_by(|(a, of_a), (b, of_b)| {
        let by_complexity = a.complexity().cmp(&b.complexity());
        by_complexity.then(of_a.cost.total_cmp(&of_b.cost))
    });
    simplest.map(|(scored, _)| *scored)
}

/// Returns the plausible set of the lowest cost, if there is one.
pub(super) fn cheapest(all: &[Scored]) -> Option<&Scored> {
    let plausible = all.iter().filter(|scored| scored.is_plausible);
    plausible.min_by(|a, b| a.cost().total_cmp(&b.cost()))
}

/// Returns true if the cost of one set exceeds that of another by at most one standard error.
pub(super) fn is_within_error(one: &Scored, other: &Scored) -> bool {
    let [excess, error] = one.excess_over(other);
    excess <= error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::costs::Costs;

    fn scored(unseen: [f64; 4], squares: [f64; 4]) -> Scored {
        let costs = Costs {
            per_sample: vec![1.0; 4],
            prior: 0.0,
        };
        Scored {
            fit: Fit {
                hypothesis: Hypothesis { terms: Vec::new() },
                x: Vec::new(),
                std: Vec::new(),
                costs,
            },
            unseen: unseen.to_vec(),
            squares: squares.to_vec(),
            moved: 0,
            is_plausible: true,
        }
    }

    #[test]
    fn of_two_sets_with_equal_robust_cost_the_one_with_the_smaller_gap_costs_less() {
        let even = scored([1.0; 4], [1.0; 4]);
        let with_bad_window = scored([0.9, 0.9, 0.9, 1.3], [1.0, 1.0, 1.0, 9.0]);
        let [excess, error] = with_bad_window.excess_over(&even);
        let expected = 0.5 * 3f64.ln();
        assert!((excess - expected).abs() < 1e-12, "{excess}");
        // One window causes the whole difference.
        assert!(error > 0.5 * excess, "{error} of {excess}");
    }
}
