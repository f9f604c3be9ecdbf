//! Finds the next effect on top of the model so far, which is called `known` here. The effects are screened, fitted and ranked, and the
//! best one is accepted or rejected.

use super::acceptance::{Acceptance, assessed};
use super::degenerate::{is_degenerate, is_excluded};
use super::episode_search;
use super::excess::level;
use super::parts::with_parts;
use super::ranking::join_all;
use super::rival::{Rival, best_of, extended};
use super::round::Round;
use super::screening::{screened, screening_windows};
use super::search::{FITTING_ITERATIONS, POLISHING_ITERATIONS, Search};
use super::shape::{loosened, reduced};
use super::shortlist::{refit_shortlist, related};
use super::tie_breaking::{held_as_stated, ordered};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::stage::Stage;
use crate::term::Term;

/// Least share of the excess that a further effect must close in screening. Otherwise no effect is fitted to all windows.
pub(super) const LEAST_PROMISED: f64 = 0.1;
/// Least share of the excess that a further effect must close in screening if the gap is at its floor already.
pub(super) const LEAST_PROMISED_AT_FLOOR: f64 = 0.5;
/// Tries every effect on top of `known`. An effect that would be scanned begins at its start in `hints` only, if it has one. Returns `None`
/// if no effect closes the share `promised` of the excess in screening.
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

/// Returns the round of an effect that is known to be present, with known parameters.
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

/// Returns the round of the effects that passed screening on top of `known`, and of an effect that was `found` in another way.
pub(super) fn round_of(
    search: &Search<'_>,
    known: &Fit,
    screened: Vec<Rival>,
    found: Option<Rival>,
) -> Option<Round> {
    let rivals = refit_shortlist(search, screened.clone(), known, found);
    judged(search, known, screened, rivals)
}

/// Ranks the rivals, improves the best one, and decides whether it is accepted. Returns `None` if no rival remains.
pub(super) fn judged(
    search: &Search<'_>,
    known: &Fit,
    screened: Vec<Rival>,
    rivals: Vec<Rival>,
) -> Option<Round> {
    (search.progress)(Stage::Judging);
    let best = best_of(&rivals)?.name;
    let rivals = held_as_stated(search, known, rivals);
    let mut rivals = ordered(search, known, rivals)?;
    let Rival { name, fit: winner } = &mut rivals[0];
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
    let acceptance = assessed(search.problem, &search.expected, known, &rivals[0]);
    Some(Round {
        known: known.clone(),
        so_far: rivals[0].fit.clone(),
        rivals,
        screened,
        acceptance,
        measured: None,
    })
}
