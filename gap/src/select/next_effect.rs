//! The next effect on top of what is known.

use super::acceptance::{Acceptance, earns_its_place};
use super::degenerate::{is_degenerate, is_excluded};
use super::episode_search;
use super::evolution::evolved;
use super::excess::{QUIET_EXCESS, level};
use super::parts::with_parts;
use super::ranking::join_all;
use super::rival::{Rival, best_of, extended};
use super::round::Round;
use super::screening::{screened, screening_windows};
use super::search::{FITTING_ITERATIONS, POLISHING_ITERATIONS, Search};
use super::shape::{loosened, reduced};
use super::shortlist::{refit_shortlist, related};
use super::tie_breaking::{held_as_stated, ordered, with_specials_polished};
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::stage::Stage;
use crate::term::Term;

/// Share of the excess that a further effect must close in screening to be fitted to all windows: as much as it must then, and
/// where the gap is at its floor, so that it can close nothing of that, much more.
pub(super) const LEAST_PROMISED: f64 = 0.1;
pub(super) const LEAST_PROMISED_AT_FLOOR: f64 = 0.5;
/// Spread, in scales, of a search around the winner where slopes lead nowhere.
const NARROWLY: f64 = 0.15;
/// Share of the excess that the model's own numbers alone must make up for to be taken from beside an effect.
const LEAST_MADE_UP: f64 = 0.5;

/// Tries every effect on top of `known`. Of effects with many starts, what `hints` found is the only one. None if none
/// closes a `promised` share of the excess in screening.
pub(crate) fn next_effect(
    search: &Search<'_>,
    known: &Fit,
    hints: &[Rival],
    promised: f64,
) -> Option<Round> {
    let chosen = screening_windows(search, known);
    let screened = screened(search, known, &chosen, hints);
    let Fit { hypothesis, x, .. } = known;
    let there = search.problem.costs(hypothesis, x, Part::Chosen(&chosen));
    let enough = there.level() - promised * (there.level() - search.expected.level);
    if promised > 0.0 && screened.iter().all(|rival| level(&rival.fit) > enough) {
        return None;
    }
    round_of(search, known, screened, None)
}

/// An effect that is known to be there, at a known size.
pub(super) fn given_effect(search: &Search<'_>, null: &Fit, term: &Term) -> Round {
    let (hypothesis, x) = extended(null, [term]);
    let fit = search
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
        acceptance: Acceptance::given(term.is_event()),
        measured: None,
    }
}

/// The round of what screening left on top of `known`, and of what was `found` there otherwise.
pub(super) fn round_of(
    search: &Search<'_>,
    known: &Fit,
    screened: Vec<Rival>,
    found: Option<Rival>,
) -> Option<Round> {
    let rivals = refit_shortlist(search, screened.clone(), known, found);
    judged(search, known, screened, rivals)
}

/// What was known without the winner of a round, from where a rival leaves the model's own numbers, if those alone make up
/// for much: the way there may lead through worse.
pub(super) fn nominal_beside(search: &Search<'_>, round: &Round) -> Option<Fit> {
    let known = &round.known;
    let excess = level(known) - search.expected.level;
    if excess <= QUIET_EXCESS {
        return None;
    }
    let below = level(known) - LEAST_MADE_UP * excess;
    let starts = round.rivals.iter();
    let starts = starts.map(|rival| rival.fit.x[..known.x.len()].to_vec());
    search.problem.fit_from_lowest(
        &known.hypothesis,
        starts.collect(),
        below,
        FITTING_ITERATIONS,
    )
}

/// A round with its winner begun anew from far around, if that leads to less.
pub(super) fn begun_afar(search: &Search<'_>, round: &Round) -> Option<Round> {
    let Rival { name, fit: winner } = &round.rivals[0];
    let of = if search.has_two_masses(winner) {
        winner
    } else {
        &round.known
    };
    let chosen = screening_windows(search, of);
    let fit = search
        .problem
        .begun_afar(winner, Part::Chosen(&chosen), FITTING_ITERATIONS);
    let fit = fit.filter(|fit| round.leaves_more_than(fit))?;
    let mut rivals = round.rivals.clone();
    rivals[0] = Rival { name, fit };
    judged(search, &round.known, round.screened.clone(), rivals)
}

/// The rivals in their order, the best one polished and judged, after what is related to it.
pub(super) fn judged(
    search: &Search<'_>,
    known: &Fit,
    screened: Vec<Rival>,
    rivals: Vec<Rival>,
) -> Option<Round> {
    (search.progress)(Stage::Judging);
    let best = best_of(&rivals)?.name;
    let rivals = with_specials_polished(search, known, rivals);
    let rivals = held_as_stated(search, known, rivals);
    let mut rivals = ordered(search, known, rivals)?;
    let Rival { name, fit: winner } = &mut rivals[0];
    if effects::of(name).landscape() == Landscape::Rugged {
        let costs = |x: &[f64]| search.problem.costs(&winner.hypothesis, x, Part::All);
        (_, winner.x) = evolved(winner.x.clone(), NARROWLY, |x| costs(x).level());
    }
    if effects::of(name).episode().is_some() {
        *winner = episode_search::found(
            search.problem,
            &search.expected,
            known,
            winner,
            FITTING_ITERATIONS,
        );
    }
    *winner = with_parts(search, winner.clone());
    if is_degenerate(search, winner) || is_excluded(search, known, winner) {
        rivals.remove(0);
        return judged(search, known, screened, rivals);
    }
    *winner = search.problem.polished(winner, POLISHING_ITERATIONS);
    if let Some(loosened) = loosened(search, known, winner) {
        *winner = loosened;
    }
    if let Some(reduced) = reduced(search, known, winner) {
        *winner = reduced;
    }
    let first = *name;
    if first != best {
        let related = related(search, &rivals[0], &screened);
        join_all(&mut rivals, related);
        rivals = held_as_stated(search, known, rivals);
        rivals = ordered(search, known, rivals)?;
    }
    let Rival { name, fit: winner } = &mut rivals[0];
    if *name != first {
        *winner = search.problem.polished(winner, POLISHING_ITERATIONS);
    }
    let acceptance = earns_its_place(search.problem, &search.expected, known, &rivals[0]);
    Some(Round {
        known: known.clone(),
        so_far: rivals[0].fit.clone(),
        rivals,
        screened,
        acceptance,
        measured: None,
    })
}
