//! Decides whether an effect is accepted. Its gain must be larger than chance.

use super::excess::is_adequate;
use super::rival::Rival;
use crate::effects;
use crate::fit::Fit;
use crate::fit::costs::Costs;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, mean_and_error};

/// Least gain on held-out windows, in its standard errors. With thirty rivals the best of them exceeds it by chance in about 1 % of the
/// searches.
const LEAST_SIGNIFICANCE: f64 = 3.3;
/// Least gain as a share of the excess of the model without the effect.
const LEAST_SHARE: f64 = 0.1;
/// Least gain in robust cost per window. The uncertainty of the sensor noise has an effect of the same size.
const LEAST_GAIN: f64 = 0.015;

/// Whether an effect is accepted, and which windows decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Acceptance {
    /// Gain on held-out windows divided by its standard error.
    pub significance: f64,
    /// True if the model with the effect is better than the model without it.
    pub accepted: bool,
    /// True if the effect is accepted by its gain in a few windows only. Such windows cannot be held out.
    pub by_few: bool,
}

impl Acceptance {
    /// Returns the acceptance of an effect that is known to be present. `by_few` is true if the effect acts in a few windows only.
    pub(crate) fn given(by_few: bool) -> Self {
        Self {
            significance: f64::INFINITY,
            accepted: true,
            by_few,
        }
    }
}

/// Decides whether `winner` is better than `known`, the fit without the last effect of `winner`. The decision uses held-out windows. For an
/// effect that may act in few windows it also uses the windows of the fit.
pub(super) fn assessed(
    problem: &Problem<'_>,
    expected: &ExpectedLoss,
    known: &Fit,
    winner: &Rival,
) -> Acceptance {
    let [without, with] = [known, &winner.fit].map(|fit| HeldOut::of(problem, fit));
    let gains = with.gains(&without);
    let (mean, error) = mean_and_error(&gains);
    // The prior cost that the effect saves is known exactly. The model parameters then deviate less from their stated values.
    let gain = mean + (known.costs.prior - winner.fit.costs.prior) / gains.len() as f64;
    let significance = gain / error.max(f64::MIN_POSITIVE);
    let excess = (without.unseen.level() - expected.level).max(0.0);
    let by_unseen = (harmless(&gains) || significance > LEAST_SIGNIFICANCE)
        && gain > LEAST_GAIN.max(LEAST_SHARE * excess);
    let seen = winner.fit.costs.gains(&known.costs);
    // If the model without the effect is adequate, only an effect that shows in a few windows is accepted.
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

/// Returns true if the gains of an effect that shows in few windows are larger than chance. Such windows cannot be held out. The sum of the
/// gains must exceed the gain that a search of many places has by chance, plus the excess of the worst window of an exact model. The other
/// windows must lose little.
pub(super) fn stands_out(gains: &[f64], expected: &ExpectedLoss) -> bool {
    gains.iter().sum::<f64>() > EVENT_GAIN + expected.worst && harmless(gains)
}

/// Returns true if the windows with a higher cost lose little compared with the gain of the other windows. By chance, losses and gains are
/// equally large. This condition accepts an effect that shows in few windows, such as an end stop.
fn harmless(gains: &[f64]) -> bool {
    let better: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    let worse: f64 = gains.iter().filter(|g| **g < 0.0).sum();
    better > HARMLESS_GAIN && -worse < HARMLESS_SHARE * better
}

/// Largest sum of the losses, as a share of the sum of the gains, at which an effect is harmless.
const HARMLESS_SHARE: f64 = 0.25;
/// Least sum of robust costs over the windows that counts as a gain. Noise alone changes the robust cost of a window by some hundredths.
const HARMLESS_GAIN: f64 = 1.5;

/// Sum of robust costs over all windows that an effect bound to an instant must gain. It is the logarithm of the number of searched places,
/// instants and sizes, with a margin.
const EVENT_GAIN: f64 = 4.0;

/// The fits of one hypothesis to two halves of the windows, and the cost of each fit on the windows of the other half.
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

    /// Returns the gain of each held-out window: its cost in `there` less its cost here. A positive gain counts only if the half of the
    /// windows that was fitted gained as well. Otherwise a parameter that does not affect that half would keep its value from the fit to
    /// all windows.
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
