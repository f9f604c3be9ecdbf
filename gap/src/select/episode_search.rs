//! Searches the intervals of a temporary effect, its number of occurrences, and its form.

use super::acceptance::stands_out;
use super::excess::level;
use super::search::FITTING_ITERATIONS;
use crate::effects::{self, Episode, episode};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::ExpectedLoss;
use crate::guess::contact::LONGEST_SHARE;
use crate::term::Term;
use rayon::prelude::*;

/// Shifts of an instant that are tried, as shares of the duration of the last occurrence.
const MOVES: [f64; 10] = [3.0, 1.6, 0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005];
/// Largest number of shifts in one search of the instants.
const MOST_MOVES: usize = 12;
/// Largest number of alternating searches of the instants and fits.
const MOST_ROUNDS: usize = 4;
/// Number of fits of lowest cost that are continued.
const CARRIED_ON: usize = 2;
/// Least strength of a temporary effect, in its standard deviations.
const SURE_ERRORS: f64 = 2.0;

/// Returns the fit with the last effect in its best form. It has as many occurrences as each gain significantly. `known` is the fit without
/// the effect.
fn found(
    problem: &Problem<'_>,
    expected: &ExpectedLoss,
    known: &Fit,
    fit: &Fit,
    iterations: usize,
) -> Fit {
    let stands_out = |fit: &Fit, on: &Fit| stands_out(&fit.costs.gains(&on.costs), expected);
    let mut best = once(problem, fit, iterations);
    if !stands_out(&best, known) {
        // One long occurrence that spans two short ones represents neither of them.
        let halves = best.last_term().map(|term| episode::halves(&term));
        let halves = halves.into_iter().flatten().map(|half| {
            let (hypothesis, x) = best.with_last(half);
            let placed = problem.fit(&hypothesis, x, Part::All, iterations);
            once(problem, &placed, iterations)
        });
        let half = halves.min_by(|a, b| level(a).total_cmp(&level(b)));
        let Some(half) = half.filter(|half| stands_out(half, known)) else {
            return best;
        };
        best = half;
    }
    while let Some(more) = again(problem, &best, iterations) {
        if !stands_out(&more, &best) {
            break;
        }
        best = more;
    }
    best
}

/// Returns a fit in which its last effect has its best intervals, number of occurrences and form, if that effect is temporary. Returns any
/// other fit as it is.
pub(crate) fn completed(problem: &Problem<'_>, expected: &ExpectedLoss, fit: Fit) -> Fit {
    let is_temporary = fit.last_term().is_some_and(|last| kind(&last).is_some());
    if !is_temporary {
        return fit;
    }
    let (hypothesis, x) = fit.without(fit.hypothesis.terms.len() - 1);
    let known = problem.fit(&hypothesis, x, Part::All, 0);
    found(problem, expected, &known, &fit, FITTING_ITERATIONS)
}

/// Returns the fit with one more occurrence of the last effect: the one of lowest cost.
fn again(problem: &Problem<'_>, fit: &Fit, iterations: usize) -> Option<Fit> {
    let windows = 0..problem.window_count();
    let costs: Vec<f64> = windows.map(|w| fit.costs.log(w)).collect();
    let last = fit.last_term()?;
    let mut returns =
        episode::with_another_occurrence(kind(&last)?, &last, &problem.series, &costs);
    returns.retain(|term| episode::total_duration_s(term) <= longest_s(problem));
    best_of(problem, fit, returns, iterations)
}

/// Returns how the intervals of a term are searched, or `None` if its effect is permanent.
fn kind(term: &Term) -> Option<&'static dyn Episode> {
    effects::of(term.kind.name).episode()
}

/// Returns the terms with all other forms of the last occurrence.
fn otherwise(term: &Term) -> Vec<Term> {
    let kind = kind(term);
    kind.map_or_else(Vec::new, |kind| kind.other_forms(term))
}

/// Returns the fit with the last effect in its best form.
fn once(problem: &Problem<'_>, fit: &Fit, iterations: usize) -> Fit {
    let term = fit.last_term().into_iter().collect();
    let best = best_of(problem, fit, term, iterations);
    let best = best.filter(|best| level(best) < level(fit));
    best.unwrap_or_else(|| fit.clone())
}

/// Returns the fit of lowest cost in which one of the `terms`, or another form of one, replaces the last effect.
fn best_of(problem: &Problem<'_>, fit: &Fit, terms: Vec<Term>, iterations: usize) -> Option<Fit> {
    let lowest = |a: &Fit, b: &Fit| level(a).total_cmp(&level(b));
    let otherwise = terms.iter().flat_map(otherwise);
    let all: Vec<Term> = terms.iter().cloned().chain(otherwise).collect();
    let short = all.into_par_iter();
    let short = short.map(|term| timed_and_fitted(problem, fit, term, iterations));
    let mut short: Vec<Fit> = short.collect();
    short.sort_by(lowest);
    short.truncate(CARRIED_ON);
    let fits = short.into_par_iter();
    let fits = fits.map(|first| carried_on(problem, first, iterations));
    fits.min_by(lowest)
}

/// Repeats the search of the instants and the fit while the cost decreases. The shifts are proportional to the duration.
fn carried_on(problem: &Problem<'_>, mut best: Fit, iterations: usize) -> Fit {
    for _ in 0..MOST_ROUNDS {
        let term = best.last_term();
        let next = term.map(|term| timed_and_fitted(problem, &best, term, iterations));
        let Some(better) = next.filter(|next| level(next) < level(&best)) else {
            break;
        };
        best = better;
    }
    best
}

/// Replaces the last effect of a fit by `term`, searches the instants of its last occurrence, and fits it.
fn timed_and_fitted(problem: &Problem<'_>, fit: &Fit, term: Term, iterations: usize) -> Fit {
    let (started, x) = fit.with_last(term.clone());
    let with = |term: &Term| {
        let mut hypothesis = started.clone();
        hypothesis.terms.pop();
        hypothesis.terms.push(term.clone());
        hypothesis
    };
    // A shift of an instant changes only the windows between its old and its new value.
    let gain = |term: &Term, moved: &Term| {
        let between = episode::changed_intervals(term, moved);
        let windows = problem.during(&between);
        let [here, there] = [term, moved].map(|term| -> f64 {
            let predictor = problem.predictor(&with(term), &x);
            let squares = problem.squares(&predictor, Part::Chosen(&windows));
            squares.iter().filter(|sum| !sum.is_nan()).sum()
        });
        here - there
    };
    let hypothesis = with(&timed(term, longest_s(problem), gain));
    problem.fit(&hypothesis, x, Part::All, iterations)
}

/// Returns the longest total duration of a temporary effect, s.
fn longest_s(problem: &Problem<'_>) -> f64 {
    LONGEST_SHARE * problem.duration_s()
}

/// Returns true if the strength of the last effect of a fit, which is temporary, is significantly above zero.
pub(super) fn is_there(fit: &Fit) -> bool {
    let [at, within] = [&fit.x, &fit.std].map(|of| fit.hypothesis.parts(of).last());
    let (Some((term, x)), Some((_, std))) = (at, within) else {
        return false;
    };
    kind(term).is_some_and(|episode| {
        let place = episode.strength();
        let strength = term.at(x)[place].abs();
        strength > SURE_ERRORS * term.spread(place, x, std)
    })
}

/// Returns true if the last effect of a fit has a lower cost as a permanent effect.
pub(super) fn is_lasting(problem: &Problem<'_>, fit: &Fit, iterations: usize) -> bool {
    let Some(term) = fit.last_term() else {
        return false;
    };
    let (hypothesis, x) = fit.with_last(episode::permanent(&term));
    let lasting = problem.fit(&hypothesis, x, Part::All, iterations);
    level(&lasting) < level(fit)
}

/// Shifts the two instants of the last occurrence until no shift has a gain. The total duration is at most `longest_s`. The gain is the
/// decrease of the sum of squared residuals, because the robust cost of a window does not change until an instant is nearly right.
fn timed(mut term: Term, longest_s: f64, gain: impl Fn(&Term, &Term) -> f64 + Sync) -> Term {
    let [from_s, to_s] = episode::instants(&term);
    for _ in 0..MOST_MOVES {
        let moves = MOVES.into_iter().flat_map(|by| [by, -by]);
        let moves: Vec<(usize, f64)> = moves.flat_map(|by| [(0, by), (1, by)]).collect();
        let moved = moves.into_par_iter().map(|(which, by)| {
            let moved = episode::with_shifted_instant(&term, which, by * (to_s - from_s).abs());
            let passes = episode::total_duration_s(&moved) <= longest_s;
            passes.then(|| (gain(&term, &moved), moved))
        });
        match moved.flatten().max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((gain, better)) if gain > 0.0 => term = better,
            _ => break,
        }
    }
    term
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::made;
    use crate::term::{Coordinate, Scale};
    use host_sim::effects::Effect;

    /// The contact of a text such as `contact:stiffness=0.3,...`. All its parameters except the side are free.
    fn contact(written: &str) -> Term {
        let Effect { kind, values } = written.parse().unwrap();
        let coordinate = |(parameter, scale): (usize, f64)| Coordinate {
            parameter,
            start: values[parameter],
            scale: Scale::Linear(scale),
        };
        let scales = [(0, 0.05), (1, 0.002), (3, 0.02), (4, 0.02), (5, 0.02)];
        Term {
            kind,
            free: scales.map(coordinate).to_vec(),
            values,
            sensor_on_load: false,
        }
    }

    #[test]
    fn a_holding_contact_is_found_from_a_short_pushing_one() {
        let held = "contact:position=0.02,side=0,stiffness=0.3,damping=0.003,from=8,to=8.9";
        let recording = made::recording(&[held]);
        let problem = made::problem(&recording);
        let pushed =
            contact("contact:position=0.02,side=1,stiffness=0.2,damping=0.005,from=8.1,to=8.3");
        let hypothesis = Hypothesis {
            terms: vec![pushed],
        };
        let x = vec![0.0; hypothesis.free()];
        let poor = problem.fit(&hypothesis, x, Part::All, 8);
        let found = once(&problem, &poor, 8);
        let (term, x) = found.hypothesis.parts(&found.x).next().unwrap();
        let values = term.at(x);
        let expected = [0.3, 0.003, 0.0, 0.02, 8.0, 8.9];
        for (value, expected) in values.iter().zip(expected) {
            assert!(
                (value - expected).abs() < 0.02 * expected.max(0.05),
                "{values:?}"
            );
        }
        assert!(level(&poor) > 2.0 * level(&found));
    }

    #[test]
    fn all_occurrences_of_a_contact_are_found_at_their_positions() {
        let start = "contact:stiffness=0.3,damping=0.003,position=0.02,side=0,from=8.1,to=8.8";
        let occurrences = [
            [0.0, 0.02, 8.0, 8.9],
            [0.0, 0.5, 1.5, 2.2],
            [1.0, -0.3, 4.0, 4.5],
        ];
        let mut held = String::from("contact:stiffness=0.3,damping=0.003");
        for (i, [side, position, from, to]) in occurrences.iter().enumerate() {
            let i = i + 1;
            held +=
                &format!(",side_{i}={side},position_{i}={position},from_{i}={from},to_{i}={to}");
        }
        let recording = made::recording(&[&held]);
        let problem = made::problem(&recording);
        let hypothesis = Hypothesis {
            terms: vec![contact(start)],
        };
        let x = vec![0.0; hypothesis.free()];
        let first = problem.fit(&hypothesis, x, Part::All, 8);
        let expected = ExpectedLoss::of(&problem, &first);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let found = found(&problem, &expected, &null, &first, 8);
        let found = found.last_term().unwrap();
        let mut again: Vec<&[f64]> = found.values[2..].chunks(4).collect();
        again.sort_by(|a, b| b[2].total_cmp(&a[2]));
        let [last, middle, first] = again[..] else {
            panic!("{again:?}");
        };
        let near = |stay: &[f64], expected: &[f64]| {
            let mut pairs = stay.iter().zip(expected);
            pairs.all(|(found, expected)| (found - expected).abs() < 0.03)
        };
        assert!(
            near(last, &occurrences[0])
                && near(first, &occurrences[1])
                && near(middle, &occurrences[2]),
            "{again:?}"
        );
    }

    #[test]
    fn one_long_occurrence_that_spans_two_is_split() {
        let held = "contact:stiffness=1,damping=0.003,side_1=0,position_1=0.5,from_1=8,to_1=8.9,\
                    side_2=0,position_2=-0.5,from_2=4.6,to_2=5.5";
        let start = "contact:stiffness=1,damping=0.003,position=0,side=0,from=4.6,to=8.9";
        let occurrences = fitted(held, start, |problem, fit| {
            let bare = Hypothesis { terms: Vec::new() };
            let null = problem.fit(&bare, Vec::new(), Part::All, 0);
            let expected = ExpectedLoss::of(problem, &null).bounded();
            let found = found(problem, &expected, &null, fit, 8);
            episode::occurrences(&found.last_term().unwrap())
        });
        assert_eq!(occurrences, 2);
    }

    /// The value of `of` for a fit of the contact `written` to a recording with the effect `hidden`.
    fn fitted<T>(hidden: &str, written: &str, of: impl Fn(&Problem<'_>, &Fit) -> T) -> T {
        let recording = made::recording(&[hidden]);
        let problem = made::problem(&recording);
        let hypothesis = Hypothesis {
            terms: vec![contact(written)],
        };
        let x = vec![0.0; hypothesis.free()];
        let fit = problem.fit(&hypothesis, x, Part::All, 8);
        of(&problem, &fit)
    }

    #[test]
    fn a_temporary_contact_in_place_of_permanent_friction_is_recognized() {
        let lasts =
            |hidden, written| fitted(hidden, written, |problem, fit| is_lasting(problem, fit, 8));
        let start = "contact:position=0,side=0,stiffness=0.001,damping=0.002,from=1,to=6";
        assert!(lasts("viscous:coefficient=0.004", start));
        let held = "contact:position=0.02,side=0,stiffness=0.3,damping=0.003,from=8,to=8.9";
        assert!(!lasts(held, held));
    }

    #[test]
    fn a_temporary_drag_is_not_a_contact_with_a_stiffness() {
        let stiff = |hidden| {
            let start = "contact:position=0,side=0,stiffness=0.01,damping=0.003,from=8,to=8.9";
            fitted(hidden, start, |_, fit| is_there(fit))
        };
        assert!(stiff(
            "contact:position=0,side=0,stiffness=0.1,damping=0.003,from=8,to=8.9"
        ));
        assert!(!stiff(
            "contact:position=0,side=0,stiffness=0,damping=0.006,from=8,to=8.9"
        ));
    }
}
