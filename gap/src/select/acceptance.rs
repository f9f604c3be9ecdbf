//! Whether an effect is accepted: whether its gain is more than chance.

use super::excess::is_adequate;
use super::rival::Rival;
use crate::effects;
use crate::fit::Fit;
use crate::fit::costs::Costs;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, mean_and_error};

/// Standard errors from zero that a gain on held-out windows must have. With thirty rivals the best of them has as much by chance in
/// about 1 % of the searches.
const LEAST_SIGNIFICANCE: f64 = 3.3;
/// Share of the excess above which a gain is hardly chance, however few the windows are, and the standard errors that such a gain must
/// have.
const LARGE_SHARE: f64 = 0.2;
const LARGE_SIGNIFICANCE: f64 = 2.0;
/// Share of the excess that every gain must be.
const LEAST_SHARE: f64 = 0.1;
/// Least gain in robust cost per window. The uncertainty of the noise of the sensor is as large.
const LEAST_GAIN: f64 = 0.015;

/// Whether an effect is accepted, and by which windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Acceptance {
    /// Gain on windows that the fit has not seen over its standard error.
    pub significance: f64,
    /// True if the effect is better than what was known.
    pub accepted: bool,
    /// True if it is so in a few windows only, which cannot be held out.
    pub by_few: bool,
}

impl Acceptance {
    /// Of what is known to be there, in few windows or not.
    pub(crate) fn given(by_few: bool) -> Self {
        Self {
            significance: f64::INFINITY,
            accepted: true,
            by_few,
        }
    }
}

/// Whether `winner` is better than what was known on windows that neither fit has seen, or where it shows in few.
pub(super) fn assessed(
    problem: &Problem<'_>,
    expected: &ExpectedLoss,
    known: &Fit,
    winner: &Rival,
) -> Acceptance {
    let [without, with] = [known, &winner.fit].map(|fit| HeldOut::of(problem, fit));
    let gains = with.gains(&without);
    let (mean, error) = mean_and_error(&gains);
    // The cost that numbers of the model save by moving less is known without an error.
    let gain = mean + (known.costs.prior - winner.fit.costs.prior) / gains.len() as f64;
    let significance = gain / error.max(f64::MIN_POSITIVE);
    let excess = (without.unseen.level() - expected.level).max(0.0);
    let least = if gain > LARGE_SHARE * excess {
        LARGE_SIGNIFICANCE
    } else {
        LEAST_SIGNIFICANCE
    };
    let by_unseen = (harmless(&gains) || significance > least)
        && gain > LEAST_GAIN.max(LEAST_SHARE * excess)
        && no_worse_at_a_quarter(problem, known, &winner.fit);
    let seen = winner.fit.costs.gains(&known.costs);
    // On top of an adequate model only an effect that shows in a few windows is accepted.
    let is_missing = known.is_strained() || !is_adequate(known, expected);
    let by_unseen = by_unseen && !winner.is_event() && is_missing;
    let may_be_few = winner.is_event() || effects::of(winner.name).may_show_in_few_windows();
    let by_few = !by_unseen && may_be_few && stands_out(&seen, expected);
    Acceptance {
        significance,
        accepted: by_unseen || by_few,
        by_few,
    }
}

/// True if an effect that shows in few windows, which cannot be held out, gains more there than a search of many places gains by
/// chance, and costs nothing in the others. The worst window of an exact model counts as chance.
pub(super) fn stands_out(gains: &[f64], expected: &ExpectedLoss) -> bool {
    gains.iter().sum::<f64>() > EVENT_GAIN + expected.worst && harmless(gains)
}

/// True if the windows that get worse are few beside those that get better: chance makes as many of either. It accepts an effect that
/// shows in few windows, such as a stop.
fn harmless(gains: &[f64]) -> bool {
    let better: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    let worse: f64 = gains.iter().filter(|g| **g < 0.0).sum();
    better > HARMLESS_GAIN && -worse < HARMLESS_SHARE * better
}

const HARMLESS_SHARE: f64 = 0.25;
/// Noise alone changes the robust cost of a window by some hundredths.
const HARMLESS_GAIN: f64 = 1.5;

/// Sum of robust costs that an effect with an instant of its own must gain: the logarithm of the number of places, instants and sizes
/// that were searched, with a margin.
const EVENT_GAIN: f64 = 4.0;

/// Fits to two halves of the windows, and what each costs on the windows of the other.
struct HeldOut {
    halves: [Fit; 2],
    unseen: Costs,
}

impl HeldOut {
    fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let halves = problem.halves(fit);
        let per_sample = Problem::held_out_by(&halves, |fit, half| {
            problem.costs(&fit.hypothesis, &fit.x, half).per_sample
        });
        let prior = fit.costs.prior;
        Self {
            halves,
            unseen: Costs { per_sample, prior },
        }
    }

    /// By how much less each window costs here than there. A gain counts where the half that it was held out from gained as well: numbers
    /// of which that half shows nothing stay as they were fitted to all windows.
    fn gains(&self, there: &Self) -> Vec<f64> {
        let saved = |half: usize| {
            let [own, other] = [self, there].map(|held| held.halves[half].costs.sum());
            other - own
        };
        let learned = [0, 1].map(|half| saved(half) > HARMLESS_GAIN);
        let gains = self.unseen.gains(&there.unseen).into_iter().enumerate();
        let foretold = |w| learned[usize::from(Part::Half(true).has(w))];
        gains
            .map(|(w, gain)| if foretold(w) { gain } else { gain.min(0.0) })
            .collect()
    }
}

/// True if a fit is no worse with restarts four times as often. A model in which nothing moves can look good on slow motion, and is
/// worse then.
fn no_worse_at_a_quarter(problem: &Problem<'_>, known: &Fit, fit: &Fit) -> bool {
    problem.quarter.as_ref().is_none_or(|quarter| {
        let costs = |fit: &Fit| quarter.costs(&fit.hypothesis, &fit.x, Part::All);
        !is_surely_worse(&costs(fit).gains(&costs(known)))
    })
}

/// True if the loss is more than chance and than the uncertainty of the noise.
fn is_surely_worse(gains: &[f64]) -> bool {
    let (mean, error) = mean_and_error(gains);
    mean < -LEAST_GAIN.max(LARGE_SIGNIFICANCE * error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_within_chance_is_not_significantly_worse() {
        let chance_gain = [-0.5, 0.3, -0.2, 0.2, -0.3, 0.1, -0.4, 0.4];
        assert!(!is_surely_worse(&chance_gain));
        assert!(is_surely_worse(&chance_gain.map(|gain| gain - 0.4)));
        let [little, more] = [0.5, 2.0].map(|f| [-f * LEAST_GAIN; 8]);
        assert!(!is_surely_worse(&little) && is_surely_worse(&more));
    }
}
