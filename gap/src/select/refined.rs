//! Finds a second effect that is so small that it shows only without an allowed model error.

use super::excess::PLAIN_GAP;
use super::next_effect::{LEAST_PROMISED, LEAST_PROMISED_AT_FLOOR, next_effect};
use super::rival::Rival;
use super::round::Round;
use super::search::{FITTING_ITERATIONS, Given, Search};
use super::selection::Selection;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::ExpectedLoss;
use crate::stage::Stage;
use rayon::prelude::*;

/// Returns the problem without an allowed model error, and the selection there: the only effect of `selection` with a second effect that
/// closes the largest share of the remaining excess. Returns `None` if the first effect explains everything, or if no second effect is
/// accepted.
pub(crate) fn refined<'a>(
    selection: &Selection,
    problem: &Problem<'a>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<(Problem<'a>, Selection)> {
    let [only] = &selection.rounds[..] else {
        return None;
    };
    if selection.given || selection.last.is_some() {
        return None;
    }
    let exact = problem.exact();
    let anew = |fit: &Fit| {
        let Fit { hypothesis, x, .. } = fit;
        exact.fit(hypothesis, x.clone(), Part::All, FITTING_ITERATIONS)
    };
    let null = anew(&selection.null);
    let mut refined = Selection {
        expected: ExpectedLoss::of(&exact, &null).bounded(),
        null,
        has_no_gap: selection.has_no_gap,
        is_unambiguous: selection.is_unambiguous,
        given: false,
        rounds: Vec::new(),
        last: None,
    };
    let so_far = anew(&only.so_far);
    if refined.suffices(&exact, &so_far) {
        return None;
    }
    let search = Search {
        problem: &exact,
        given,
        progress,
        expected: refined.expected,
    };
    // Far above the floor an effect is missing, even if no effect closes much of the excess in screening.
    let promised = if exact.gap_over_floor(&so_far) > PLAIN_GAP {
        LEAST_PROMISED
    } else {
        LEAST_PROMISED_AT_FLOOR
    };
    let second = next_effect(&search, &so_far, &only.screened, promised)?;
    if !second.acceptance.accepted {
        return None;
    }
    let rivals = only.rivals.par_iter().map(|rival| Rival {
        name: rival.name,
        fit: anew(&rival.fit),
    });
    let first = Round {
        known: refined.null.clone(),
        rivals: rivals.collect(),
        screened: only.screened.clone(),
        acceptance: only.acceptance,
        so_far,
        measured: None,
    };
    refined.rounds = vec![first, second];
    Some((exact, refined))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::made;
    use crate::select::select;

    /// Names of the effects found with an allowed model error, which is a share of the gap, and then without it.
    fn found(effects: &[&str]) -> [Vec<&'static str>; 2] {
        let recording = made::recording(effects);
        let mut problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let nominal = problem.fit(&bare, Vec::new(), Part::All, 0);
        problem.modelling = 0.2 * problem.plain_gap(&problem.series, &nominal);
        let given = Given::A_GAP;
        let coarse = select(&problem, None, &given, |_| {});
        let refined = refined(&coarse, &problem, &given, |_| {});
        let names = |selection: &Selection| {
            let rounds = selection.rounds.iter();
            rounds.map(|round| round.rivals[0].name).collect()
        };
        let refined = refined.map_or(Vec::new(), |(_, refined)| names(&refined));
        [names(&coarse), refined]
    }

    #[test]
    fn a_second_effect_within_the_allowed_model_error_is_found() {
        let [coarse, refined] = found(&["coulomb:level=0.008", "delay:time=1e-3"]);
        assert_eq!(coarse, ["coulomb"]);
        assert_eq!(refined, ["coulomb", "delay"]);
    }

    #[test]
    fn no_second_effect_is_found_after_a_complete_one() {
        let [coarse, refined] = found(&["coulomb:level=0.008"]);
        assert_eq!(coarse, ["coulomb"]);
        assert!(refined.is_empty(), "{refined:?}");
    }
}
