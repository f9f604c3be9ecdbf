//! One more effect on top of what is known.

use super::evolution::evolved;
use super::finals::{best_of, join_all};
use super::hand;
use super::place::{Place, earns_its_place};
use super::rival::{Rival, extended};
use super::{Given, QUIET_EXCESS, level};
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::Perfect;
use crate::stage::Stage;
use crate::term::Term;

/// Iterations for all finalists, for those that are near the best then, and more for the one that is named.
pub(super) const SHORT_ITERATIONS: usize = 3;
pub(super) const FITTING_ITERATIONS: usize = 8;
pub(super) const POLISHING_ITERATIONS: usize = 15;
/// Spread, in scales, of a search around the winner where slopes lead nowhere.
const NARROWLY: f64 = 0.15;
/// Share of the excess that the model's own numbers alone must make up for to be taken from beside an effect.
const LEAST_MADE_UP: f64 = 0.5;

/// One effect on top of what was known, with what stood beside it.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// What was known without it.
    pub known: Fit,
    /// All finalists, the winner first, the others by what they leave.
    pub rivals: Vec<Rival>,
    /// Every effect as screening left it.
    pub screened: Vec<Rival>,
    /// Whether the winner is better than what was known.
    pub place: Place,
    /// The model with the effects up to this one.
    pub so_far: Fit,
    /// What is known of the winner where it was measured beside all other effects.
    pub measured: Option<Measured>,
}

/// What measuring an effect beside all others of its set says of it.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// Probability that it is right.
    pub confidence: f64,
    /// Effects in whose place it costs no less, within the error.
    pub ties: Vec<&'static str>,
}

impl Round {
    /// True if a fit leaves less than its winner does.
    pub(super) fn leaves_more_than(&self, fit: &Fit) -> bool {
        level(fit) < level(&self.rivals[0].fit)
    }

    /// The same on top of what is `known` without one of the effects before it.
    pub(super) fn without(&self, problem: &Problem<'_>, place: usize, known: Fit) -> Self {
        let (hypothesis, x) = self.so_far.without(place);
        let fit = problem.fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Self {
            known,
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: self.rivals[0].name,
                fit,
            }],
            screened: Vec::new(),
            place: self.place,
            measured: self.measured.clone(),
        }
    }
}

/// What all rounds share.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub given: &'a Given<'a>,
    /// Told of each stage.
    pub progress: fn(Stage),
    pub perfect: Perfect,
}

impl Search<'_> {
    /// Tries every effect on top of `known`. Of effects with many starts, what `hints` found is the only one. None if none
    /// closes a `promised` share of the excess in screening.
    pub(crate) fn round(&self, known: &Fit, hints: &[Rival], promised: f64) -> Option<Round> {
        let chosen = self.screening_windows(known);
        let screened = self.screened(known, &chosen, hints);
        let Fit { hypothesis, x, .. } = known;
        let there = self.problem.costs(hypothesis, x, Part::Chosen(&chosen));
        let enough = there.level() - promised * (there.level() - self.perfect.level);
        if promised > 0.0 && screened.iter().all(|rival| level(&rival.fit) > enough) {
            return None;
        }
        self.round_of(known, screened, None)
    }

    /// An effect that is known to be there, at a known size.
    pub(crate) fn given(&self, null: &Fit, term: &Term) -> Round {
        let (hypothesis, x) = extended(null, [term]);
        let fit = self
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Round {
            known: null.clone(),
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: term.kind.name,
                fit,
            }],
            screened: Vec::new(),
            place: Place::given(term.is_event()),
            measured: None,
        }
    }

    /// The round of what screening left on top of `known`, and of what was `found` there otherwise.
    pub(super) fn round_of(
        &self,
        known: &Fit,
        screened: Vec<Rival>,
        found: Option<Rival>,
    ) -> Option<Round> {
        let rivals = self.finals(screened.clone(), known, found);
        self.judged(known, screened, rivals)
    }

    /// Level up to which nothing is missing.
    pub(super) fn quiet(&self) -> f64 {
        self.perfect.level + QUIET_EXCESS
    }

    /// What was known without the winner of a round, from where a rival leaves the model's own numbers, if those alone make up
    /// for much: the way there may lead through worse.
    pub(crate) fn nominal_beside(&self, round: &Round) -> Option<Fit> {
        let known = &round.known;
        let excess = level(known) - self.perfect.level;
        if excess <= QUIET_EXCESS {
            return None;
        }
        let below = level(known) - LEAST_MADE_UP * excess;
        let starts = round.rivals.iter();
        let starts = starts.map(|rival| rival.fit.x[..known.x.len()].to_vec());
        self.problem.fit_from_lowest(
            &known.hypothesis,
            starts.collect(),
            below,
            FITTING_ITERATIONS,
        )
    }

    /// A round with its winner begun anew from far around, if that leads to less.
    pub(crate) fn begun_afar(&self, round: &Round) -> Option<Round> {
        let Rival { name, fit: winner } = &round.rivals[0];
        let of = if self.has_two_masses(winner) {
            winner
        } else {
            &round.known
        };
        let chosen = self.screening_windows(of);
        let fit = self
            .problem
            .begun_afar(winner, Part::Chosen(&chosen), FITTING_ITERATIONS);
        let fit = fit.filter(|fit| round.leaves_more_than(fit))?;
        let mut rivals = round.rivals.clone();
        rivals[0] = Rival { name, fit };
        self.judged(&round.known, round.screened.clone(), rivals)
    }

    /// The rivals in their order, the best one polished and judged, after what is related to it.
    pub(super) fn judged(
        &self,
        known: &Fit,
        screened: Vec<Rival>,
        rivals: Vec<Rival>,
    ) -> Option<Round> {
        (self.progress)(Stage::Judging);
        let best = best_of(&rivals)?.name;
        let rivals = self.with_specials_polished(known, rivals);
        let rivals = self.held_as_stated(known, rivals);
        let mut rivals = self.ordered(known, rivals)?;
        let Rival { name, fit: winner } = &mut rivals[0];
        if effects::of(name).landscape() == Landscape::Rugged {
            let costs = |x: &[f64]| self.problem.costs(&winner.hypothesis, x, Part::All);
            (_, winner.x) = evolved(winner.x.clone(), NARROWLY, |x| costs(x).level());
        }
        if effects::of(name).comes_and_goes() {
            *winner = hand::found(
                self.problem,
                &self.perfect,
                known,
                winner,
                FITTING_ITERATIONS,
            );
        }
        if self.is_misnamed(winner) || self.is_excluded(known, winner) {
            rivals.remove(0);
            return self.judged(known, screened, rivals);
        }
        *winner = self.problem.polished(winner, POLISHING_ITERATIONS);
        if let Some(loosened) = self.loosened(known, winner) {
            *winner = loosened;
        }
        if let Some(reduced) = self.reduced(known, winner) {
            *winner = reduced;
        }
        let first = *name;
        if first != best {
            let related = self.related(&rivals[0], &screened);
            join_all(&mut rivals, related);
            rivals = self.held_as_stated(known, rivals);
            rivals = self.ordered(known, rivals)?;
        }
        let Rival { name, fit: winner } = &mut rivals[0];
        if *name != first {
            *winner = self.problem.polished(winner, POLISHING_ITERATIONS);
        }
        let place = earns_its_place(self.problem, &self.perfect, known, &rivals[0]);
        Some(Round {
            known: known.clone(),
            so_far: rivals[0].fit.clone(),
            rivals,
            screened,
            place,
            measured: None,
        })
    }
}

/// What a search for one more effect on top of a bare nominal model comes to.
#[cfg(test)]
pub(super) fn on<T>(
    recording: &recording::Recording,
    look: impl FnOnce(&Search<'_>, &Fit) -> T,
) -> T {
    let problem = crate::made::problem(recording);
    let bare = crate::fit::hypothesis::Hypothesis { terms: Vec::new() };
    let null = problem.fit(&bare, Vec::new(), Part::All, 0);
    let search = Search {
        problem: &problem,
        given: &Given::A_GAP,
        progress: |_| {},
        perfect: Perfect::of(&problem, &null).bounded(),
    };
    look(&search, &null)
}
