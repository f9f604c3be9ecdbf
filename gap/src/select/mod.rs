//! Which effects earn their place.

mod acceptance;
mod degenerate;
mod episode_search;
mod evolution;
mod excess;
mod extension;
mod near_equivalents;
mod next_effect;
mod pair;
mod pair_screening;
mod parts;
mod ranking;
mod refined;
mod rival;
mod round;
mod scan;
mod screening;
mod screening_set;
mod search;
mod selection;
mod shape;
mod shortlist;
mod tie_breaking;

use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};
use crate::stage::Stage;
pub(crate) use acceptance::Acceptance;
pub(crate) use excess::{LOUD_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, QUIET_GAP};
use excess::{QUIET_ERRORS, is_at_floor, is_quiet, level};
use extension::extended;
pub(crate) use next_effect::next_effect;
use next_effect::{begun_afar, given_effect, nominal_beside};
use ranking::is_far_likelier;
pub(crate) use ranking::{inseparable, luck, others, ties};
pub(crate) use refined::refined;
pub(crate) use rival::Rival;
pub(crate) use round::{Measured, Round};
pub(crate) use search::{Given, Search};
pub(crate) use selection::Selection;

/// Robust excess per window, beyond as many standard errors, that a gap near its floor does not hide: a floor that a restart or
/// two make is none for the others. Of 86 recordings with nothing wrong but a dry friction of another form it was 1.3 at most.
const PLAIN_EXCESS: f64 = 2.0;
/// Gap over floor of a run by itself beyond which something is missing: of 92 recordings with nothing wrong but a dry friction of
/// another form it was 2.9 in two, and beyond that in two that such a friction explains.
const LOUD_RUN: f64 = 5.0;
const NULL_ITERATIONS: usize = 10;
/// Effects that may do together what a ripple that was not seen to repeat does.
const MOST_PULLS: usize = 2;
/// Share of the excess that the better of two effects closes by itself at least, or robust cost that it saves, as for 18 % of
/// the gap, in each window or of the whole: far above the floor a share is more than one of two may close.
const LEAST_GAIN_ALONE: f64 = 0.1;
const LEAST_SAVED_ALONE: f64 = 0.4;
/// Share of the excess that one effect may leave for its fit to begin anew from far around before a second is looked for.
const MOST_LEFT_BY_ONE: f64 = 0.9;

/// Finds the effect that explains most, or the two that do together, then what is left beside them, each
/// fitted jointly with the others, and with the terms of `base`, which say numbers of the model that are not stated.
pub(crate) fn select(
    problem: &Problem<'_>,
    base: Option<Fit>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Selection {
    progress(Stage::Nominal);
    let bare = || {
        let bare = Hypothesis { terms: Vec::new() };
        let x = vec![0.0; bare.dimensions(&problem.priors)];
        let null = problem.fit(&bare, x, Part::All, NULL_ITERATIONS);
        problem.nominal_afar(&null, NULL_ITERATIONS).unwrap_or(null)
    };
    let null = base.unwrap_or_else(bare);
    let found = select_beyond(null.clone(), problem, given, progress);
    let Some(ripple) = found.unrepeated(problem) else {
        return found;
    };
    pulls(&found, ripple, null, problem, given, progress).unwrap_or(found)
}

/// What is found without a ripple of which less than a wave was travelled, if that does as much.
fn pulls(
    found: &Selection,
    ripple: &'static str,
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<Selection> {
    let mut without = given.clone();
    without.excluded.push(ripple);
    let pulls = select_beyond(null, problem, &without, progress);
    let [rippled, pulled] = [found.rounds.last()?, pulls.rounds.last()?];
    let suffice = pulls.rounds.len() <= MOST_PULLS && pulls.suffices(problem, &pulled.so_far);
    let do_as_much = !is_far_likelier(&rippled.rivals[0], &pulled.rivals[0]);
    (suffice && do_as_much).then_some(pulls)
}

/// The same beyond what the nominal model leaves.
fn select_beyond(
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Selection {
    let expected = ExpectedLoss::of(problem, &null);
    let mut selection = Selection {
        has_no_gap: is_quiet(&null, &expected) && problem.gap_over_floor(&null) <= LOUD_GAP,
        is_unambiguous: null.costs.mean() - expected.level
            > PLAIN_EXCESS + QUIET_ERRORS * expected.error
            || problem.loudest_over_floor(&null) > LOUD_RUN,
        expected: expected.bounded(),
        null,
        given: false,
        rounds: Vec::new(),
        last: None,
    };
    // What two columns show is there, whatever the tolerances could make of it.
    let is_hidden = || !given.certain && selection.null_leaves_at_most(FLOOR_DOUBT, problem);
    selection.has_no_gap |= !selection.is_unambiguous && (!given.is_gap || is_hidden());
    if selection.has_no_gap {
        return selection;
    }
    let search = Search {
        problem,
        given,
        progress,
        expected: selection.expected,
    };
    let certain = given.measured.as_ref().filter(|_| given.certain);
    let first = match certain {
        Some(term) => Some(given_effect(&search, &selection.null, term)),
        None => next_effect(&search, &selection.null, &[], 0.0),
    };
    let Some(mut first) = first else {
        return selection;
    };
    selection.given = certain.is_some();
    if let Some(null) = nominal_beside(&search, &first) {
        return select_beyond(null, problem, given, progress);
    }
    let mut suffices = selection.suffices(problem, &first.so_far);
    if selection.left(&first.so_far) < MOST_LEFT_BY_ONE
        && !selection.given
        && !suffices
        && let Some(anew) = begun_afar(&search, &first)
    {
        suffices = selection.suffices(problem, &anew.so_far);
        first = anew;
    }
    if first.acceptance.earned && suffices {
        selection.add(first);
        return selection;
    }
    let hints = first.screened.clone();
    // Where the gap is at its floor, what else there may be stands beside the first, not in its place.
    let leaves_little =
        selection.leaves_little(&first.so_far) || is_at_floor(problem, &first.so_far);
    let settled = selection.given || first.acceptance.earned && leaves_little;
    let saves = |cost: &dyn Fn(&Fit) -> f64| {
        cost(&selection.null) - cost(&first.so_far) > LEAST_SAVED_ALONE
    };
    let promises = || {
        selection.left(&first.so_far) < 1.0 - LEAST_GAIN_ALONE
            || saves(&level)
            // Of a gap that is in few windows most of them know nothing.
            || saves(&|fit| 2.0 * problem.gap_over_floor(fit).ln())
    };
    // Where none does much alone, no second is looked for on top of any.
    let pair = |lead: bool| pair::pair(&search, &first, lead, |both| !selection.is_hopeless(both));
    let rounds = (!settled).then(|| pair(promises())).flatten();
    // One of the two may do what both do.
    let is_pair = rounds.is_some();
    let found = selection.with(rounds.unwrap_or_else(|| vec![first.clone()]));
    let is_alone = is_pair && found.rounds.len() == 1;
    if is_alone && found.suffices(problem, found.fit()) {
        return found;
    }
    let found = extended(&search, found, &hints);
    if !settled || selection.given {
        return found;
    }
    // What leaves little of the excess may still stand in for two that leave less of the gap, or at the floor for two that are
    // far likelier.
    let left = problem.gap_over_floor(found.fit());
    let is_near = left <= QUIET_GAP;
    if is_near && (found.rounds.len() > 1 || found.suffices(problem, found.fit())) {
        return found;
    }
    let Some(pair) = pair(!is_near).map(|rounds| selection.with(rounds)) else {
        return found;
    };
    let is_better = match (&pair.rounds[..], &found.rounds[..]) {
        _ if !is_near => problem.gap_over_floor(pair.fit()) < left,
        ([_, both], [one]) => is_far_likelier(&both.rivals[0], &one.rivals[0]),
        _ => false,
    };
    if is_better { pair } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    /// What is found of some effects, in the order of the alphabet.
    fn found(hidden: &[&str]) -> Vec<&'static str> {
        let recording = made::recording(hidden);
        let selection = select(&made::problem(&recording), None, &Given::A_GAP, |_| {});
        let rounds = selection.rounds.iter();
        let mut names: Vec<&str> = rounds.map(|round| round.rivals[0].name).collect();
        names.sort_unstable();
        names
    }

    #[test]
    fn friction_that_drifts_from_another_level_is_another_level_too() {
        let friction = found(&["coulomb:level=0.007", "friction_drift:rate=0.1,settling=0"]);
        assert_eq!(friction, ["coulomb", "friction_drift"]);
    }
}
