//! Finds the next effect on top of the model so far, which is called `known` here. The effects are screened, fitted and ranked, and the
//! best one is accepted or rejected.

use super::acceptance::{Acceptance, assessed};
use super::degenerate::{is_degenerate, is_excluded};
use super::parts::with_parts;
use super::rival::{Rival, extended};
use super::round::Round;
use super::screening::{screened, screening_windows};
use super::search::{FITTING_ITERATIONS, POLISHING_ITERATIONS, Search};
use super::shape::{loosened, reduced};
use super::shortlist::refit_shortlist;
use super::tie_breaking::{held_as_stated, ordered};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::stage::Stage;
use crate::term::Term;

/// Tries every effect on top of `known`. Returns `None` if no effect remains.
pub(crate) fn next_effect(search: &Search<'_>, known: &Fit) -> Option<Round> {
    let chosen = screening_windows(search, known);
    let screened = screened(search, known, &chosen, &[]);
    let rivals = refit_shortlist(search, screened.clone(), known);
    judged(search, known, screened, rivals)
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

/// Ranks the rivals, improves the best one, and decides whether it is accepted. Returns `None` if no rival remains.
fn judged(
    search: &Search<'_>,
    known: &Fit,
    screened: Vec<Rival>,
    rivals: Vec<Rival>,
) -> Option<Round> {
    (search.progress)(Stage::Judging);
    let rivals = held_as_stated(search, known, rivals);
    let mut rivals = ordered(search, known, rivals)?;
    let winner = &mut rivals[0].fit;
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
