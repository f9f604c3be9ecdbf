//! Detects fitted effects that do not act as their names say.

use super::episode_search;
use super::excess::level;
use super::ranking::enough;
use super::search::{FITTING_ITERATIONS, POLISHING_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::plausible::is_true_to_names;

/// Returns true if the last effect of a fit does not act as its name says, such as a ripple of which less than one period was travelled. If
/// the model is not adequate, a temporary effect must end, and its strength must be significant.
pub(super) fn is_degenerate(search: &Search<'_>, fit: &Fit) -> bool {
    let Some(last) = fit.last_term() else {
        return false;
    };
    let effect = effects::of(last.kind.name);
    if effect.episode().is_some() && level(fit) > search.adequate_level() {
        return !episode_search::is_there(fit)
            || episode_search::is_lasting(search.problem, fit, FITTING_ITERATIONS);
    }
    !is_true_to_names(search.problem, fit)
}

/// Returns true if a special case of the last effect is excluded from the search and explains nearly as much.
pub(super) fn is_excluded(search: &Search<'_>, known: &Fit, fit: &Fit) -> bool {
    let Some(last) = fit.last_term() else {
        return false;
    };
    let excluded = search.given.excluded.iter();
    let effect = effects::of(last.kind.name);
    let special = excluded.filter(|special| effect.contains(special));
    let mut special = special.filter_map(|special| last.reduced(effects::of(special).kind()));
    special.any(|special| {
        let (mut hypothesis, mut x) = fit.without(fit.hypothesis.terms.len() - 1);
        x.resize(x.len() + special.free.len(), 0.0);
        hypothesis.terms.push(special);
        let reduced = search
            .problem
            .fit(&hypothesis, x, Part::All, POLISHING_ITERATIONS);
        level(&reduced) <= enough(known, fit)
    })
}

#[cfg(test)]
mod tests {
    use super::super::Given;
    use super::super::next_effect::given_effect;
    use super::super::search::on;
    use super::*;
    use crate::made;
    use crate::term::{Coordinate, Scale};
    use recording::Recording;

    /// Whether an effect with some of its parameters at these values, by their index, is degenerate.
    fn is_degenerate_at(recording: &Recording, name: &str, values: &[(usize, f64)]) -> bool {
        let mut term = made::term(name, &[]);
        for &(parameter, value) in values {
            term.values[parameter] = value;
        }
        on(recording, |search, null| {
            is_degenerate(search, &given_effect(search, null, &term).so_far)
        })
    }

    #[test]
    fn a_spring_that_comes_back_later_than_a_prediction_ends_is_a_lag() {
        let recording = made::recording(&[]);
        let is_degenerate =
            |damping| is_degenerate_at(&recording, "compliance", &[(0, 0.5), (1, damping)]);
        let latest = 0.5 * recording.horizon;
        assert!(!is_degenerate(0.5 * latest) && is_degenerate(2.0 * latest));
    }

    #[test]
    fn a_spring_with_next_to_nothing_behind_it_is_no_transmission() {
        let recording = made::recording(&[]);
        let is_degenerate =
            |load_share| is_degenerate_at(&recording, "compliance", &[(2, load_share)]);
        assert_eq!([0.02, 0.2, 0.98].map(is_degenerate), [true, false, true]);
    }

    #[test]
    fn a_ripple_of_less_than_one_period_is_no_ripple() {
        let recording = made::recording(&[]);
        let is_degenerate =
            |wave_number| is_degenerate_at(&recording, "cogging", &[(0, 0.01), (1, wave_number)]);
        assert_eq!([0.15, 20.0].map(is_degenerate), [true, false]);
    }

    /// Whether a backlash is rejected because a compliance, which is excluded from the search, explains as much.
    fn is_twist(hidden: &str) -> bool {
        let log = |parameter, start| Coordinate {
            parameter,
            start,
            scale: Scale::Log,
        };
        let backlash = made::term("backlash", &[log(0, 0.01), log(2, 2.0), log(3, 0.005)]);
        let recording = made::recording(&[hidden]);
        on(&recording, |search, null| {
            let found = given_effect(search, null, &backlash).so_far;
            let given = Given {
                excluded: vec!["compliance"],
                ..Given::A_GAP
            };
            let search = Search {
                given: &given,
                problem: search.problem,
                progress: search.progress,
                expected: search.expected,
            };
            is_excluded(&search, null, &found)
        })
    }

    #[test]
    fn play_that_is_no_more_than_a_twist_is_none() {
        assert!(is_twist("compliance:stiffness=2.0,damping=0.005"));
        assert!(!is_twist("backlash:play=0.02"));
    }
}
