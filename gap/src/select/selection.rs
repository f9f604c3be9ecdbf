//! The effects that were found, and what they leave.

use super::degenerate::repeats;
use super::excess::{
    LOUD_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, QUIET_EXCESS, QUIET_GAP, is_at_floor, is_quiet, level,
};
use super::round::Round;
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};
use crate::term::Term;

/// Effects that are found at most.
const MOST_EFFECTS: usize = 3;
/// Share of the robust excess that two effects may leave for a third to be looked for.
const HOPELESS: f64 = 0.75;

/// The outcome: the null, and a round for each effect.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    pub null: Fit,
    /// True if the loss of the null is that of an exact model, or its gap that of noise and restarts: nothing that could be seen is
    /// missing.
    pub has_no_gap: bool,
    /// True if the loss is so much larger in every window or in one run that something is missing, though the gap is near its floor.
    pub is_unambiguous: bool,
    /// True if the first round was given.
    pub given: bool,
    /// Expected loss if the null were exact, as far as it can stand in for the device.
    pub expected: ExpectedLoss,
    pub rounds: Vec<Round>,
    /// The round that found nothing more.
    pub last: Option<Round>,
}

impl Selection {
    /// The fit with all effects.
    pub(crate) fn fit(&self) -> &Fit {
        self.rounds.last().map_or(&self.null, |round| &round.so_far)
    }

    /// The name of a ripple among the effects of which less than a wave was travelled, if there is one.
    pub(super) fn unrepeated(&self, problem: &Problem<'_>) -> Option<&'static str> {
        let mut winners = self.rounds.iter().map(|round| &round.rivals[0]);
        let unrepeated = winners.find(|winner| !repeats(problem, &winner.fit));
        unrepeated.map(|winner| winner.name)
    }

    /// True if its effects were measured beside each other at an error scale of their own: what they leave is no measure of whether
    /// there is a gap.
    pub(crate) fn is_measured(&self) -> bool {
        self.rounds.iter().any(|round| round.measured.is_some())
    }

    /// True if no effect is among those found of which data could be held out.
    pub(crate) fn shows_in_few(&self) -> bool {
        self.rounds.iter().all(|round| round.acceptance.by_few)
    }

    /// Terms of the null: numbers of the model that are not stated, and estimated with every hypothesis.
    pub(crate) fn base(&self) -> usize {
        self.null.hypothesis.terms.len()
    }

    /// Effects that were given: they are there whatever they close.
    pub(crate) fn kept(&self) -> usize {
        usize::from(self.given)
    }

    /// Takes an effect that has earned its place; one that has not is the last that was looked for.
    pub(super) fn add(&mut self, round: Round) {
        if round.acceptance.earned {
            self.rounds.push(round);
        } else {
            self.last = Some(round);
        }
    }

    /// The same with some rounds more.
    pub(super) fn with(&self, rounds: Vec<Round>) -> Self {
        let mut more = self.clone();
        for round in rounds {
            more.add(round);
        }
        more
    }

    /// True if one more effect may be found on top of those there are.
    pub(super) fn goes_on(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let hopeless = !self.given && self.is_hopeless(fit);
        let possible = self.last.is_none() && !hopeless;
        possible
            && match self.rounds.len() {
                // The second of two may be small beside the first.
                1 => true,
                2..MOST_EFFECTS => {
                    !self.leaves_little(fit) || problem.gap_over_floor(fit) > LOUD_GAP
                }
                _ => false,
            }
    }

    /// Takes back the effects from one on; the first of them found nothing more, then.
    pub(crate) fn withdraw(&mut self, from: usize) {
        self.last = self.rounds.drain(from..).next();
    }

    /// Takes back the last effect, without which the others are as they were fitted then.
    pub(crate) fn withdraw_last(&mut self, others: Fit) {
        self.last = self.rounds.pop();
        if let Some(round) = self.rounds.last_mut() {
            round.so_far = others;
        }
    }

    /// Takes back one effect; those after it are fitted anew without it.
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

    /// Share of the null's robust excess that a fit leaves; none where there is no excess but in a window or two.
    pub(crate) fn left(&self, fit: &Fit) -> f64 {
        let excess = level(&self.null) - self.expected.level;
        if excess <= QUIET_EXCESS {
            return 0.0;
        }
        ((level(fit) - self.expected.level) / excess).max(0.0)
    }

    /// The same beyond what the fit would leave if it were right, unless that is more than it does leave.
    pub(crate) fn missing(&self, problem: &Problem<'_>, fit: &Fit) -> f64 {
        let own = ExpectedLoss::of(problem, fit).level;
        let excess = level(&self.null) - own;
        if own > level(fit) || excess <= QUIET_EXCESS {
            return self.left(fit);
        }
        (level(fit) - own) / excess
    }

    /// True if the effects leave what wrong names do, be it of the gap, and do not spare the model's own numbers a move that is
    /// not likely.
    pub(crate) fn leaves_most(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let spares = fit.is_likely() && !self.null.is_likely();
        self.left(fit) > MOST_LEFT && !spares && !is_at_floor(problem, fit)
    }

    /// True if the model's own numbers, moved no farther than is likely, leave no more than so many times what noise and
    /// restarts do.
    pub(crate) fn null_leaves_at_most(&self, floors: f64, problem: &Problem<'_>) -> bool {
        self.null.is_likely() && problem.gap_over_floor(&self.null) <= floors
    }

    /// True if a fit leaves so much that nothing more can bring a name.
    pub(super) fn is_hopeless(&self, fit: &Fit) -> bool {
        self.left(fit) > HOPELESS
    }

    /// True if a fit leaves less than a further effect must close, and does not bend the model's own numbers for it.
    pub(super) fn leaves_little(&self, fit: &Fit) -> bool {
        fit.is_likely() && self.left(fit) <= MOST_LEFT_EXPLAINED
    }

    /// True if it leaves no more than it would if it were right, where that is little beside what the null leaves, or as much
    /// of the gap as is foretold: near stick and slip even a right model leaves more than little. Or if little is left of the
    /// excess, and nothing of the gap.
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
        // After some impacts even the right model has lost its way.
        let mut terms = fit.hypothesis.terms.iter();
        let bounces = |t: &Term| effects::of(t.kind.name).landscape() == Landscape::Rugged;
        let expected = if terms.any(bounces) {
            expected
        } else {
            expected.bounded()
        };
        let as_foretold = || (1.0 / QUIET_GAP..QUIET_GAP).contains(&over_floor());
        is_quiet(fit, &expected) && (leaves_little || as_foretold())
    }
}
