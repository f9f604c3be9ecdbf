//! The result of a search is a selection: the effects that were found, and the share of the excess that remains with them.

use super::excess::{
    ADEQUATE_EXCESS, ADEQUATE_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, is_adequate, is_at_floor, level,
};
use super::rival::Rival;
use super::round::Round;
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};
use crate::term::Term;

/// The null, which is the fit of the model without effects, and a round for each effect.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    pub null: Fit,
    /// True if no effect is searched. The null is then adequate, or the tolerances of the model parameters bring its gap to its floor, or
    /// the nominal model has no gap.
    pub has_no_gap: bool,
    /// True if an effect is missing although the gap may be near its floor. The mean cost of the windows is then far above that of an exact
    /// model, or the gap of one run is large.
    pub is_unambiguous: bool,
    /// True if the effect of the first round was known before the search.
    pub given: bool,
    /// Expected cost of the null if it were exact.
    pub expected: ExpectedLoss,
    pub rounds: Vec<Round>,
    /// The round whose effect was not accepted or was withdrawn.
    pub last: Option<Round>,
    /// Pairs of effects that are worth a comparison, best first.
    pub proposed: Vec<Rival>,
}

impl Selection {
    /// Returns the fit with all effects.
    pub(crate) fn fit(&self) -> &Fit {
        self.rounds.last().map_or(&self.null, |round| &round.so_far)
    }

    /// Returns the fit of the best pair, or of the best effect alone if its cost is lower, or the null if there is neither.
    pub(crate) fn best(&self) -> &Fit {
        self.best_sets().next().unwrap_or_else(|| self.fit())
    }

    /// Returns the fits of pairs, and then of effects alone, whose cost is not above that of the best effect alone. The best pair comes first.
    pub(crate) fn best_sets(&self) -> impl Iterator<Item = &Fit> {
        let alone = self.rounds.iter().flat_map(|round| &round.rivals);
        let most = level(self.fit());
        let fits = self.proposed.iter().chain(alone).map(|rival| &rival.fit);
        fits.filter(move |fit| level(fit) <= most)
    }

    /// Returns the fit without the effects that were searched.
    pub(crate) fn known(&self) -> &Fit {
        if self.given {
            &self.rounds[0].so_far
        } else {
            &self.null
        }
    }

    /// Returns true if an accepted effect, or one of a pair that leaves little of the excess, has this name.
    pub(crate) fn names_best(&self, name: &str) -> bool {
        let accepted = self.rounds.iter().filter(|r| r.acceptance.accepted);
        let pair = self.proposed.first().map(|pair| &pair.fit);
        let pair = pair.filter(|pair| self.leaves_little(pair));
        let mut fits = accepted.map(|round| &round.rivals[0].fit).chain(pair);
        fits.any(|fit| fit.hypothesis.names().contains(&name))
    }

    /// Returns true if the last effect was accepted and leaves nothing to explain.
    pub(crate) fn is_explained(&self, problem: &Problem<'_>) -> bool {
        let last = self.rounds.last();
        last.is_some_and(|round| self.is_explained_by(problem, round))
    }

    /// Returns true if the effect of a round was accepted and leaves nothing to explain.
    pub(super) fn is_explained_by(&self, problem: &Problem<'_>, round: &Round) -> bool {
        round.acceptance.accepted && self.suffices(problem, &round.so_far)
    }

    /// Returns true if its sets of effects were compared at an error scale that was estimated for them. The cost at that scale does not
    /// show whether there is a gap.
    pub(crate) fn is_measured(&self) -> bool {
        self.rounds.iter().any(|round| round.measured.is_some())
    }

    /// Returns true if all its effects were accepted by so few windows that none could be held out.
    pub(crate) fn shows_in_few(&self) -> bool {
        self.rounds.iter().all(|round| round.acceptance.by_few)
    }

    /// Returns the number of terms of the null. They are model parameters that are not stated, and every fit estimates them.
    pub(crate) fn base(&self) -> usize {
        self.null.hypothesis.terms.len()
    }

    /// Returns the number of effects that are kept whatever they close: those known before the search.
    pub(crate) fn kept(&self) -> usize {
        usize::from(self.given)
    }

    /// Withdraws the rounds from the index `from`. The first of them becomes the round that was not accepted.
    pub(crate) fn withdraw(&mut self, from: usize) {
        self.last = self.rounds.drain(from..).next();
    }

    /// Withdraws one effect. The rounds after it are fitted again without it.
    pub(crate) fn withdraw_one(&mut self, problem: &Problem<'_>, place: usize) {
        let base = self.base();
        let mut later = self.rounds.split_off(place).into_iter();
        self.last = later.next();
        self.rounds.extend(later);
        let mut known = match place.checked_sub(1) {
            Some(before) => self.rounds[before].so_far.clone(),
            None => self.null.clone(),
        };
        for round in &mut self.rounds[place..] {
            *round = round.without(problem, base + place, known);
            known = round.so_far.clone();
        }
    }

    /// Returns the share of the excess of the null that remains with a fit. It is 0 if the null is within the excess of an adequate model.
    pub(crate) fn left(&self, fit: &Fit) -> f64 {
        let excess = level(&self.null) - self.expected.level;
        if excess <= ADEQUATE_EXCESS {
            return 0.0;
        }
        ((level(fit) - self.expected.level) / excess).max(0.0)
    }

    /// Returns the share of the excess of the null that remains with a fit. Here the excess is measured from the expected cost of that fit
    /// if it were exact. If the cost of the fit is lower than that, the result is that of [`left`](Self::left).
    pub(crate) fn missing(&self, problem: &Problem<'_>, fit: &Fit) -> f64 {
        let own = ExpectedLoss::of(problem, fit).level;
        let excess = level(&self.null) - own;
        if own > level(fit) || excess <= ADEQUATE_EXCESS {
            return self.left(fit);
        }
        (level(fit) - own) / excess
    }

    /// Returns true if as much of the excess remains as with wrong effects and the gap is not at its floor. It returns false if the effects
    /// make an implausible deviation of the model parameters unnecessary.
    pub(crate) fn leaves_most(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let spares = fit.is_likely() && !self.null.is_likely();
        self.left(fit) > MOST_LEFT && !spares && !is_at_floor(problem, fit)
    }

    /// Returns true if plausible deviations of the model parameters reduce the gap to at most `floors` times its floor.
    pub(crate) fn null_leaves_at_most(&self, floors: f64, problem: &Problem<'_>) -> bool {
        self.null.is_likely() && problem.gap_over_floor(&self.null) <= floors
    }

    /// Returns true if little of the excess remains with a fit, and the deviations of the model parameters are plausible.
    fn leaves_little(&self, fit: &Fit) -> bool {
        fit.is_likely() && self.left(fit) <= MOST_LEFT_EXPLAINED
    }

    /// Returns true if a fit explains everything. One condition is that little of the excess remains and the gap is at its floor. The other
    /// is that the fit is adequate and either little of the excess remains or the gap is within a factor of two of its floor. Near stick
    /// and slip more excess may remain even with a right model.
    pub(crate) fn suffices(&self, problem: &Problem<'_>, fit: &Fit) -> bool {
        if fit.is_strained() {
            return false;
        }
        let over_floor = || problem.gap_over_floor(fit);
        let leaves_little = self.leaves_little(fit);
        if leaves_little && over_floor() <= FLOOR_DOUBT {
            return true;
        }
        let expected = ExpectedLoss::of(problem, fit);
        // After some impacts even the right model predicts another motion.
        let mut terms = fit.hypothesis.terms.iter();
        let bounces = |t: &Term| effects::of(t.kind.name).landscape() == Landscape::Rugged;
        let expected = if terms.any(bounces) {
            expected
        } else {
            expected.bounded()
        };
        let as_foretold = || (1.0 / ADEQUATE_GAP..ADEQUATE_GAP).contains(&over_floor());
        is_adequate(fit, &expected) && (leaves_little || as_foretold())
    }
}
