//! Converts the chosen set to a selection with a round for each of its effects.

use super::agreement;
use super::order::{order, subset_fit};
use super::pool::ScoredPool;
use super::scored::{Scored, is_within_error};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, mean_and_error};
use crate::select::{Acceptance, Measured, Rival, Round, Selection};

/// Number of iterations of the fit without an effect that was known before the search.
const GIVEN_ITERATIONS: usize = 5;

/// Returns the selection with the effects of `set`, ordered by the share of the gap that each closes. Each effect has a round beside all
/// others of the set. Its rivals are the sets of `pool` that have another effect in its place.
pub(super) fn of(
    problem: &Problem<'_>,
    found: &Selection,
    set: &Scored,
    pool: &ScoredPool,
) -> Selection {
    let known = &pool.null.fit;
    let kept = known.hypothesis.terms.len();
    let order = order(problem, set, kept);
    let given = found.given.then(|| given(problem, &found.rounds[0], known));
    let null = given.as_ref().map_or(known, |round| &round.known).clone();
    let found_by_search = order.iter().enumerate().map(|(rank, &place)| {
        let taken = &order[..=rank];
        let so_far = subset_fit(problem, &set.fit, kept, |p| taken.contains(&p));
        let so_far = in_order(&so_far, kept, |fit, at| {
            rank_of(fit, at, &set.fit, &order, kept)
        });
        round(problem, set, pool, kept + place, so_far, found)
    });
    let found_by_search: Vec<Round> = found_by_search.collect();
    Selection {
        expected: ExpectedLoss::of(problem, &null).bounded(),
        null,
        has_no_gap: false,
        is_unambiguous: true,
        given: found.given,
        rounds: given.into_iter().chain(found_by_search).collect(),
        last: beyond(set, pool),
        proposed: Vec::new(),
    }
}

/// Returns the round of an effect that was known before the search, with the fit `known` that contains it as its last term.
fn given(problem: &Problem<'_>, round: &Round, known: &Fit) -> Round {
    let (hypothesis, x) = known.without(known.hypothesis.terms.len() - 1);
    let mut round = round.clone();
    round.known = problem.fit(&hypothesis, x, Part::All, GIVEN_ITERATIONS);
    round.so_far = known.clone();
    round.rivals.truncate(1);
    round.rivals[0].fit = known.clone();
    round
}

/// Returns the rank, within the whole set, of the effect at a place of a fit.
fn rank_of(fit: &Fit, at: usize, set: &Fit, order: &[usize], kept: usize) -> usize {
    let name = fit.hypothesis.terms[at].kind.name;
    let of_place = |place: &usize| set.hypothesis.terms[kept + place].kind.name == name;
    order.iter().position(of_place).unwrap_or(order.len())
}

/// Returns a fit with its effects beyond the first `kept` sorted by `rank`.
fn in_order(fit: &Fit, kept: usize, rank: impl Fn(&Fit, usize) -> usize) -> Fit {
    let mut places: Vec<usize> = (0..fit.hypothesis.terms.len()).collect();
    places[kept..].sort_by_key(|&at| rank(fit, at));
    permuted(fit, &places)
}

/// Returns a fit with its effects and their coordinates in the order of `places`.
fn permuted(fit: &Fit, places: &[usize]) -> Fit {
    let numbers = fit.x.len() - fit.hypothesis.free();
    let parts: Vec<_> = fit.hypothesis.parts(&fit.x).collect();
    let spreads: Vec<_> = fit.hypothesis.parts(&fit.std).collect();
    let mut moved = fit.clone();
    moved.hypothesis.terms.clear();
    moved.x.truncate(numbers);
    moved.std.truncate(numbers);
    for &place in places {
        let (term, x) = parts[place];
        moved.hypothesis.terms.push(term.clone());
        moved.x.extend_from_slice(x);
        moved.std.extend_from_slice(spreads[place].1);
    }
    moved
}

/// Returns a fit with the effect at a place moved behind all others.
fn with_last(fit: &Fit, place: usize) -> Fit {
    let others = (0..fit.hypothesis.terms.len()).filter(|p| *p != place);
    permuted(fit, &others.chain([place]).collect::<Vec<_>>())
}

/// Returns the round of the effect at a place of the set, beside all others of the set.
fn round(
    problem: &Problem<'_>,
    set: &Scored,
    pool: &ScoredPool,
    place: usize,
    so_far: Fit,
    found: &Selection,
) -> Round {
    let name = set.fit.hypothesis.terms[place].kind.name;
    let (hypothesis, x) = set.fit.without(place);
    let without = Scored::of(problem, &hypothesis, x);
    let [excess, error] = without.excess_over(set);
    let winner = Rival {
        name,
        fit: with_last(&set.fit, place),
    };
    let mut others = set.names();
    others.retain(|other| *other != name);
    let swapped = pool.sets.iter().filter_map(|rival| {
        let terms = &rival.fit.hypothesis.terms;
        let other = terms.iter().position(|term| {
            let mut rest = rival.names();
            rest.retain(|n| *n != term.kind.name);
            term.kind.name != name && rest == others
        })?;
        Some((terms[other].kind.name, other, rival))
    });
    let swapped: Vec<(&'static str, usize, &Scored)> = swapped.collect();
    let is_tied = |other: &str, rival: &Scored| {
        rival.is_plausible && is_within_error(rival, set) && !effects::of(other).contains(name)
    };
    let tied = swapped
        .iter()
        .filter(|(other, _, rival)| is_tied(other, rival));
    let ties: Vec<&'static str> = tied.map(|(other, ..)| *other).collect();
    let swapped = swapped.iter().map(|&(name, other, rival)| Rival {
        name,
        fit: with_last(&rival.fit, other),
    });
    let rivals: Vec<Rival> = core::iter::once(winner).chain(swapped).collect();
    let is_event = rivals[0].is_event();
    let is_agreed = found.names_best(name);
    let confidence = confidence(
        agreement::share(&pool.sets, name),
        is_agreed && ties.is_empty(),
        closed(problem, set, pool),
        is_event,
    );
    Round {
        known: without.fit,
        rivals,
        screened: Vec::new(),
        acceptance: Acceptance {
            significance: excess / error.max(f64::MIN_POSITIVE),
            accepted: true,
            by_few: is_event,
        },
        so_far,
        measured: Some(Measured { confidence, ties }),
    }
}

/// Returns the share of the gap that a set closes on held-out windows.
fn closed(problem: &Problem<'_>, set: &Scored, pool: &ScoredPool) -> f64 {
    let [left, before] = [set, &pool.null].map(|scored| problem.rms(&scored.squares));
    (1.0 - left / before.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// Returns the probability that a name is right. It increases with the share of resamplings that choose the name, and with the share of the
/// gap that its set closes. A name is agreed if the search with the model parameters near their stated values found it as well, and no
/// other effect in its place explains as much. An effect bound to an instant was not held out, and can fit any residual there.
fn confidence(share: f64, is_agreed: bool, closed: f64, is_event: bool) -> f64 {
    let (least, most) = if is_agreed { (0.4, 0.95) } else { (0.3, 0.65) };
    let sure = least + (most - least) * share * closed;
    if is_event {
        sure.min(SURE_OF_EVENT)
    } else {
        sure
    }
}

/// Highest probability of a name that was found in few windows, if no single effect explains the device.
const SURE_OF_EVENT: f64 = 0.45;

/// Returns a round that was not accepted, on top of the whole set. Its rivals are the sets of `pool` with exactly one effect that `set`
/// does not have. Returns `None` if there is no such set.
fn beyond(set: &Scored, pool: &ScoredPool) -> Option<Round> {
    let names = set.names();
    let mut rivals: Vec<Rival> = Vec::new();
    for rival in &pool.sets {
        let terms = rival.fit.hypothesis.terms.iter().enumerate();
        let more: Vec<_> = terms
            .filter(|(_, term)| !names.contains(&term.kind.name))
            .collect();
        if let [(place, term)] = more[..]
            && rivals.iter().all(|r| r.name != term.kind.name)
        {
            rivals.push(Rival {
                name: term.kind.name,
                fit: with_last(&rival.fit, place),
            });
        }
    }
    let first = rivals.first()?;
    let gains = first.fit.costs.gains(&set.fit.costs);
    let (mean, error) = mean_and_error(&gains);
    Some(Round {
        known: set.fit.clone(),
        so_far: first.fit.clone(),
        screened: Vec::new(),
        acceptance: Acceptance {
            significance: mean / error.max(f64::MIN_POSITIVE),
            accepted: false,
            by_few: false,
        },
        rivals,
        measured: None,
    })
}
