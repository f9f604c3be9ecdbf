//! Searches effects with the model parameters near their stated values: the effect that closes the largest share of the excess alone, and
//! pairs of effects if it does not explain everything.

mod acceptance;
mod degenerate;
pub(crate) mod episode_search;
mod evolution;
mod excess;
mod near_equivalents;
mod next_effect;
mod pair;
mod pair_screening;
mod parts;
mod ranking;
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
use excess::{ADEQUATE_ERRORS, is_adequate};
pub(crate) use excess::{ADEQUATE_GAP, MOST_LEFT, MOST_LEFT_EXPLAINED, PLAIN_GAP};
use next_effect::given_effect;
pub(crate) use next_effect::next_effect;
pub(crate) use ranking::{chance_gain, inseparable, others, ties};
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

/// Finds the best effect alone. If it does not explain everything, it also proposes pairs of effects. All are fitted jointly with the terms
/// of `base`, which are the model parameters that are not stated.
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
        proposed: Vec::new(),
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
    if let Some(term) = given.measured.as_ref().filter(|_| given.certain) {
        selection.given = true;
        let round = given_effect(&search, &selection.null, term);
        selection.rounds.push(round);
        if selection.suffices(problem, selection.fit()) {
            return selection;
        }
    }
    let Some(first) = next_effect(&search, selection.fit()) else {
        return selection;
    };
    if !selection.is_explained_by(problem, &first) {
        selection.proposed = pair::proposed(&search, &first);
    }
    selection.rounds.push(first);
    selection
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
