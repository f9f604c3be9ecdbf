//! The result of a search: the effects that were found, and the share of the excess that they leave.

use super::degenerate::repeats;
use super::excess::{
    ADEQUATE_EXCESS, ADEQUATE_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, PLAIN_GAP, is_adequate,
    is_at_floor, level,
};
use super::round::Round;
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};
use crate::term::Term;

/// Most effects of a selection.
const MOST_EFFECTS: usize = 3;
/// Share of the excess that effects may leave for a further one to be searched.
const HOPELESS: f64 = 0.75;

/// The null, which is the model without effects, and a round for each effect.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    pub null: Fit,
    /// True if the null costs no more than an exact model, or its gap is at its floor.
    pub has_no_gap: bool,
    /// True if something is missing although the gap is near its floor: the cost is higher in every window, or the gap of one run is large.
    pub is_unambiguous: bool,
    /// True if the effect of the first round was known before the search.
    pub given: bool,
    /// Expected cost if the null were exact.
    pub expected: ExpectedLoss,
    pub rounds: Vec<Round>,
    /// The round whose effect was not accepted.
    pub last: Option<Round>,
}

impl Selection {
    /// The fit with all effects.
    pub(crate) fn fit(&self) -> &Fit {
        self.rounds.last().map_or(&self.null, |round| &round.so_far)
    }

    /// Name of a ripple among the effects of which less than a wave was travelled, if there is one.
    pub(super) fn unrepeated(&self, problem: &Problem<'_>) -> Option<&'static str> {
        let mut winners = self.rounds.iter().map(|round| &round.rivals[0]);
        let unrepeated = winners.find(|winner| !repeats(problem, &winner.fit));
        unrepeated.map(|winner| winner.name)
    }

    /// True if its effects were compared in sets at an error scale of their own. The cost at that scale does not say whether there is a
    /// gap.
    pub(crate) fn is_measured(&self) -> bool {
        self.rounds.iter().any(|round| round.measured.is_some())
    }

    /// True if all its effects show in so few windows that none could be held out.
    pub(crate) fn shows_in_few(&self) -> bool {
        self.rounds.iter().all(|round| round.acceptance.by_few)
    }

    /// Number of terms of the null: they are numbers of the model that are not stated, and estimated in every fit.
    pub(crate) fn base(&self) -> usize {
        self.null.hypothesis.terms.len()
    }

    /// Number of effects that are kept whatever they close: those known before the search.
    pub(crate) fn kept(&self) -> usize {
        usize::from(self.given)
    }

    /// Adds a round whose effect was accepted; another one ends the search.
    pub(super) fn add(&mut self, round: Round) {
        if round.acceptance.accepted {
            self.rounds.push(round);
        } else {
            self.last = Some(round);
        }
    }

    /// This selection with further rounds.
    pub(super) fn with(&self, rounds: Vec<Round>) -> Self {
        let mut more = self.clone();
        for round in rounds {
            more.add(round);
        }
        more
    }

    /// True if a further effect is to be searched.
    pub(super) fn goes_on(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let hopeless = !self.given && self.is_hopeless(fit);
        let possible = self.last.is_none() && !hopeless;
        possible
            && match self.rounds.len() {
                // The second of two may be small beside the first.
                1 => true,
                2..MOST_EFFECTS => {
                    !self.leaves_little(fit) || problem.gap_over_floor(fit) > PLAIN_GAP
                }
                _ => false,
            }
    }

    /// Withdraws the rounds from one on; the first of them ends the search.
    pub(crate) fn withdraw(&mut self, from: usize) {
        self.last = self.rounds.drain(from..).next();
    }

    /// Withdraws the last effect; the `others` are the fit without it.
    pub(crate) fn withdraw_last(&mut self, others: Fit) {
        self.last = self.rounds.pop();
        if let Some(round) = self.rounds.last_mut() {
            round.so_far = others;
        }
    }

    /// Withdraws one effect; those after it are fitted anew without it.
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

    /// Share of the excess of the null that a fit leaves; 0 where the null has hardly any excess.
    pub(crate) fn left(&self, fit: &Fit) -> f64 {
        let excess = level(&self.null) - self.expected.level;
        if excess <= ADEQUATE_EXCESS {
            return 0.0;
        }
        ((level(fit) - self.expected.level) / excess).max(0.0)
    }

    /// Share of the excess of the null that a fit leaves, where the excess is that over the expected cost of the fit if it were exact. As
    /// [`left`](Self::left) says where the fit costs less than that.
    pub(crate) fn missing(&self, problem: &Problem<'_>, fit: &Fit) -> f64 {
        let own = ExpectedLoss::of(problem, fit).level;
        let excess = level(&self.null) - own;
        if own > level(fit) || excess <= ADEQUATE_EXCESS {
            return self.left(fit);
        }
        (level(fit) - own) / excess
    }

    /// True if the effects leave as much of excess and gap as wrong names do, and do not save the numbers of the model an unlikely move.
    pub(crate) fn leaves_most(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let spares = fit.is_likely() && !self.null.is_likely();
        self.left(fit) > MOST_LEFT && !spares && !is_at_floor(problem, fit)
    }

    /// True if the numbers of the model, moved within their tolerances, bring the gap down to so many times its floor.
    pub(crate) fn null_leaves_at_most(&self, floors: f64, problem: &Problem<'_>) -> bool {
        self.null.is_likely() && problem.gap_over_floor(&self.null) <= floors
    }

    /// True if a fit leaves so much that a further effect cannot make it explain the gap.
    pub(super) fn is_hopeless(&self, fit: &Fit) -> bool {
        self.left(fit) > HOPELESS
    }

    /// True if a fit leaves less than a further effect must close, without an unlikely move of the numbers of the model.
    pub(super) fn leaves_little(&self, fit: &Fit) -> bool {
        fit.is_likely() && self.left(fit) <= MOST_LEFT_EXPLAINED
    }

    /// True if a fit explains everything: it leaves little of the excess, and its gap is at the floor; or it costs no more than it would
    /// if it were exact, and leaves little of the excess or as much of the gap as its floor says. Near stick and slip even a right model
    /// may leave more than little.
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
