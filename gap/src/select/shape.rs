//! Decides which parameters of the last effect of a fit are free.

use super::excess::{is_at_floor, level};
use super::ranking::enough;
use super::search::{POLISHING_ITERATIONS, SHORT_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::term::Term;

/// Returns a fit with the shape parameters of its last effect free. Returns `None` if the gap is at its floor, if there are no further
/// shape parameters, or if the gain is too small for them.
pub(super) fn loosened(search: &Search<'_>, known: &Fit, given: &Fit) -> Option<Fit> {
    if is_at_floor(search.problem, given) {
        return None;
    }
    let fit = with_more_free(search, given)?;
    (level(given) > enough(known, &fit))
        .then(|| search.problem.polished(&fit, POLISHING_ITERATIONS))
}

/// Returns a fit with the shape parameters of its last effect free. Returns `None` if it has no further shape parameters.
pub(super) fn with_more_free(search: &Search<'_>, given: &Fit) -> Option<Fit> {
    let [low, high] = search.problem.extremes();
    let half_span = 0.5 * (high - low);
    let (hypothesis, x) = given.loosened(|term| with_shape_free(term, half_span))?;
    let part = Part::All;
    Some(
        search
            .problem
            .fit(&hypothesis, x, part, POLISHING_ITERATIONS),
    )
}

/// Returns a fit with its last effect in a form of fewer free parameters. Returns `None` if no such form explains nearly as much.
pub(super) fn reduced(search: &Search<'_>, known: &Fit, full: &Fit) -> Option<Fit> {
    let (last, others) = full.hypothesis.terms.split_last()?;
    let (before, own) = full.x.split_at(full.x.len() - last.free.len());
    let model = &search.problem.recording.model;
    let effect = effects::of(last.kind.name);
    let forms = effect.reduced_forms(last, own, model, search.problem.extremes());
    let fits = forms.into_iter().map(|(form, own)| {
        let terms = [others, &[form]].concat();
        let x = [before, &own].concat();
        let hypothesis = Hypothesis { terms };
        search
            .problem
            .fit(&hypothesis, x, Part::All, SHORT_ITERATIONS)
    });
    let enough = enough(known, full);
    let fits = fits.filter(|fit| level(fit) <= enough);
    fits.min_by(|a, b| level(a).total_cmp(&level(b)))
}

/// Returns an effect with its further shape parameters free, for a motion of ± `half_span`. Returns `None` if it has no further shape
/// parameters.
fn with_shape_free(given: &Term, half_span: f64) -> Option<Term> {
    let shape = effects::of(given.kind.name).further_shape(given, half_span);
    let starts: Vec<(usize, f64)> = shape.iter().map(|c| (c.parameter, c.start)).collect();
    let mut loosened = given.starting_at(&starts);
    loosened.free.extend(&shape);
    (!shape.is_empty()).then_some(loosened)
}

#[cfg(test)]
mod tests {
    use super::super::next_effect::given_effect;
    use super::super::search::on;
    use super::loosened;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    /// Fitted exponent and tail of the decrease of static friction with speed. The fit begins with both fixed, the exponent at 1 and the
    /// tail at 0.
    fn freed([exponent, tail]: [f64; 2]) -> Option<[f64; 2]> {
        let hidden =
            format!("stribeck:static_ratio=2.5,velocity=1.0,exponent={exponent},tail={tail}");
        let free = [(0, 2.0), (1, 0.5)].map(|(parameter, start)| Coordinate {
            parameter,
            start,
            scale: Scale::Log,
        });
        let mut stribeck = made::term("stribeck", &free);
        stribeck.values[2] = 1.0;
        on(&made::recording(&[&hidden]), |search, null| {
            let given = given_effect(search, null, &stribeck).so_far;
            let freed = loosened(search, null, &given)?;
            let [_, _, exponent, tail] = freed.last_term()?.values[..] else {
                return None;
            };
            Some([exponent, tail])
        })
    }

    #[test]
    fn the_hardening_of_a_spring_is_freed_only_if_it_exists() {
        let hardening = |hidden: f64| {
            let spring = format!("spring:stiffness=0.06,zero=0,hardening={hidden}");
            let free = Coordinate {
                parameter: 0,
                start: 0.05,
                scale: Scale::Log,
            };
            on(&made::recording(&[&spring]), |search, null| {
                let term = made::term("spring", &[free]);
                let given = given_effect(search, null, &term).so_far;
                Some(loosened(search, null, &given)?.last_term()?.values[2])
            })
        };
        assert_eq!(hardening(0.0), None);
        let found = hardening(2.0).unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.02, "{found}");
    }

    #[test]
    fn the_middle_of_a_sensor_curve_is_freed_if_it_is_not_zero() {
        const BENT: &str = "sensor_nonlinearity:quadratic=0.3,cubic=1.5,middle=0.08";
        // Several sets of parameters describe the same sensor curve, so its slope at zero is compared.
        let steeper =
            |[square, cube, middle]: [f64; 3]| middle * (3.0 * cube * middle - 2.0 * square);
        let free = [0, 1].map(|parameter| Coordinate {
            parameter,
            start: 0.0,
            scale: Scale::Linear(1.0),
        });
        let found = on(&made::recording(&[BENT]), |search, null| {
            let around_zero = made::term("sensor_nonlinearity", &free);
            let given = given_effect(search, null, &around_zero).so_far;
            let freed = loosened(search, null, &given)?.last_term()?;
            Some(steeper([0, 1, 6].map(|place| freed.values[place])))
        });
        let hidden = steeper([0.3, 1.5, 0.08]);
        assert!((found.unwrap() / hidden - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn the_exponent_of_static_friction_is_freed_if_the_start_is_wrong() {
        assert_eq!(freed([1.0, 0.0]), None);
        for hidden in [[2.0, 0.0], [2.0, 1.0]] {
            let freed = freed(hidden).unwrap();
            for (found, there) in freed.iter().zip(hidden) {
                assert!((found - there).abs() < 0.2, "{freed:?} for {hidden:?}");
            }
        }
    }
}
