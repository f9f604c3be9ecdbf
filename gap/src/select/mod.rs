//! Searches effects with the model parameters near their stated values. The first result is the effect, or the pair of effects, that closes
//! the largest share of the excess. Further effects are then added to it.

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
use excess::{ADEQUATE_ERRORS, is_adequate, is_at_floor, level};
pub(crate) use excess::{ADEQUATE_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, PLAIN_GAP};
use extension::extended;
use next_effect::given_effect;
pub(crate) use next_effect::next_effect;
use ranking::is_far_likelier;
pub(crate) use ranking::{chance_gain, inseparable, others, ties};
pub(crate) use refined::refined;
pub(crate) use rival::Rival;
pub(crate) use round::{Measured, Round};
pub(crate) use search::{Given, Search};
pub(crate) use selection::Selection;

/// Excess per window beyond which an effect is missing although the gap is near its floor. One or two windows can dominate both gap and
/// floor. The largest excess of 86 recordings whose only deviation was another form of dry friction was 1.3.
const PLAIN_EXCESS: f64 = 2.0;
/// Gap over floor of a single run beyond which an effect is missing. Of 92 recordings whose only deviation was another form of dry friction
/// two had 2.9. Two others had more, and a dry friction of another form explains that.
const PLAIN_RUN: f64 = 5.0;
/// Number of iterations of the fit of the null.
const NULL_ITERATIONS: usize = 10;
/// Least share of the excess that the first effect must close alone for further effects to be searched on top of it.
const LEAST_GAIN_ALONE: f64 = 0.1;
/// Gain in robust cost per window that suffices instead. It corresponds to a decrease of the gap by 18 %. Far above the floor even one of
/// two right effects closes only a small share of the excess.
const LEAST_SAVED_ALONE: f64 = 0.4;

/// Largest number of effects that may replace a ripple of which less than one period was travelled.
const MOST_IN_PLACE: usize = 2;

/// Finds the effect, or the pair of effects, that closes the largest share of the excess, and then further effects. All are fitted jointly
/// with the terms of `base`, which are the model parameters that are not stated.
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
    without_ripple(&found, ripple, null, problem, given, progress).unwrap_or(found)
}

/// Returns the effects that are found if a ripple of which less than one period was travelled is excluded. Returns `None` if they are more
/// than two, if they do not explain everything, or if the ripple is far likelier.
fn without_ripple(
    found: &Selection,
    ripple: &'static str,
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<Selection> {
    let mut without = given.clone();
    without.excluded.push(ripple);
    let others = select_beyond(null, problem, &without, progress);
    let [rippled, other] = [found.rounds.last()?, others.rounds.last()?];
    let suffice = others.rounds.len() <= MOST_IN_PLACE && others.suffices(problem, &other.so_far);
    let explain_as_much = !is_far_likelier(&rippled.rivals[0], &other.rivals[0]);
    (suffice && explain_as_much).then_some(others)
}

/// Returns the effects that are found on top of a null.
fn select_beyond(
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Selection {
    let expected = ExpectedLoss::of(problem, &null);
    let mut selection = Selection {
        has_no_gap: is_adequate(&null, &expected) && problem.gap_over_floor(&null) <= PLAIN_GAP,
        is_unambiguous: null.costs.mean() - expected.level
            > PLAIN_EXCESS + ADEQUATE_ERRORS * expected.error
            || problem.worst_run_over_floor(&null) > PLAIN_RUN,
        expected: expected.bounded(),
        null,
        given: false,
        rounds: Vec::new(),
        last: None,
    };
    // An effect that a comparison of two position columns shows is present, even if the tolerances of the model parameters could explain
    // the gap.
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
    let Some(first) = first else {
        return selection;
    };
    selection.given = certain.is_some();
    let suffices = selection.suffices(problem, &first.so_far);
    if first.acceptance.accepted && suffices {
        selection.add(first);
        return selection;
    }
    let hints = first.screened.clone();
    // If the gap is at its floor, a further effect is added to the first one and does not replace it.
    let leaves_little =
        selection.leaves_little(&first.so_far) || is_at_floor(problem, &first.so_far);
    let settled = selection.given || first.acceptance.accepted && leaves_little;
    let saves = |cost: &dyn Fn(&Fit) -> f64| {
        cost(&selection.null) - cost(&first.so_far) > LEAST_SAVED_ALONE
    };
    let promises = || {
        selection.left(&first.so_far) < 1.0 - LEAST_GAIN_ALONE
            || saves(&level)
            // A gap in few windows hardly changes the mean cost over all windows.
            || saves(&|fit| 2.0 * problem.gap_over_floor(fit).ln())
    };
    // If no single effect closes much, pairs are proposed together instead of on top of a first effect.
    let pair = |lead: bool| pair::pair(&search, &first, lead, |both| !selection.is_hopeless(both));
    let rounds = (!settled).then(|| pair(promises())).flatten();
    // The pair may be reduced to one effect that explains as much.
    let is_pair = rounds.is_some();
    let found = selection.with(rounds.unwrap_or_else(|| vec![first.clone()]));
    let is_alone = is_pair && found.rounds.len() == 1;
    if is_alone && found.suffices(problem, found.fit()) {
        return found;
    }
    extended(&search, found, &hints)
}

#[cfg(test)]
mod tests {
    use crate::diagnose::{Options, diagnose};
    use crate::made;

    #[test]
    fn a_drifting_friction_with_another_level_is_found_as_two_effects() {
        let recording =
            made::recording(&["coulomb:level=0.007", "friction_drift:rate=0.1,settling=0"]);
        let effects = diagnose(&recording, &Options::default()).diagnosis.effects;
        let mut names: Vec<&str> = effects.iter().map(|effect| effect.name).collect();
        names.sort_unstable();
        assert_eq!(names, ["coulomb", "friction_drift"]);
    }
}
