//! Prefers simpler rivals to others whose cost is slightly lower.

use super::degenerate::repeats;
use super::excess::{MOST_LEFT_EXPLAINED, is_adequate, level};
use super::ranking::{is_as_likely, ranked};
use super::rival::Rival;
use super::search::{FITTING_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::floor::ExpectedLoss;

/// Returns the rivals with the stated parameter of each effect fixed at its stated value if the fit is then nearly as good.
pub(super) fn held_as_stated(
    search: &Search<'_>,
    known: &Fit,
    mut rivals: Vec<Rival>,
) -> Vec<Rival> {
    let model = &search.problem.recording.model;
    for rival in &mut rivals {
        let stated = effects::of(rival.name).stated_parameter(model);
        let held = stated.and_then(|(place, value)| rival.with_held(place, value));
        let Some(mut held) = held else {
            continue;
        };
        let Fit { hypothesis, x, .. } = held.fit;
        held.fit = search
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        if let Some(mut both) = ranked(vec![rival.clone(), held], known, search.adequate_level()) {
            *rival = both.swap_remove(0);
        }
    }
    rivals
}

/// Returns the rivals with the best one first. A special case precedes the form that contains it if the data do not require that form.
/// Returns `None` if there is no rival.
pub(super) fn ordered(search: &Search<'_>, known: &Fit, rivals: Vec<Rival>) -> Option<Vec<Rival>> {
    let mut rivals = ranked(rivals, known, search.adequate_level())?;
    let best = level(&rivals[0].fit);
    let short_by = |share: f64| best + share * (level(known) - best);
    let halfway = short_by(0.5);
    // A ripple of which less than one period was travelled may be a spring. If the fit with the ripple is adequate, the spring must gain
    // nearly as much. Otherwise it must gain half as much.
    let pulls = (!repeats(search.problem, &rivals[0].fit)).then(|| {
        if best > search.adequate_level() {
            halfway
        } else {
            short_by(MOST_LEFT_EXPLAINED)
        }
    });
    let special = rivals.iter().position(|rival| {
        // If an effect that always acts explains everything, the same effect at certain instants only is not needed.
        let leaves_nothing = || {
            level(&rival.fit) <= halfway
                && is_as_likely(rival, &rivals[0])
                && is_adequate(
                    &rival.fit,
                    &ExpectedLoss::of(search.problem, &rival.fit).bounded(),
                )
        };
        effects::of(rivals[0].name).contains(rival.name)
            && (pulls.is_some_and(|most| level(&rival.fit) <= most) || leaves_nothing())
    });
    if let Some(special) = special {
        let special = rivals.remove(special);
        rivals.insert(0, special);
    }
    Some(rivals)
}

#[cfg(test)]
mod tests {
    use super::super::next_effect::given_effect;
    use super::super::search::on;
    use super::ordered;
    use crate::made;
    use crate::term::{Coordinate, Scale, Term};
    use core::f64::consts::PI;

    #[test]
    fn a_spring_is_preferred_to_a_ripple_of_less_than_one_period() {
        let free = |parameter, start| Coordinate {
            parameter,
            start,
            scale: Scale::Linear(0.2 * start),
        };
        let first = |amplitude: f64, wave_number: f64| {
            let hidden =
                format!("cogging:amplitude={amplitude},wave_number={wave_number},phase={PI}");
            on(&made::recording(&[&hidden]), |search, null| {
                let ripple = Term {
                    values: vec![amplitude, wave_number, PI, 0.0, 0.0],
                    ..made::term("cogging", &[free(0, amplitude), free(1, wave_number)])
                };
                let spring = made::term("spring", &[free(0, 0.05)]);
                let rivals = [ripple, spring].into_iter();
                let rivals = rivals.flat_map(|term| given_effect(search, null, &term).rivals);
                let ordered = ordered(search, null, rivals.collect()).unwrap();
                ordered[0].name
            })
        };
        assert_eq!(first(0.25, 0.12), "spring");
        // The torque bends too much for a spring.
        assert_eq!(first(0.2, 0.15), "cogging");
        assert_eq!(first(0.02, 20.0), "cogging");
    }
}
