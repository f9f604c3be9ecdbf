//! Prefers simpler rivals to others whose cost is slightly lower.

use super::excess::{is_adequate, level};
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
    let halfway = best + 0.5 * (level(known) - best);
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
        effects::of(rivals[0].name).contains(rival.name) && leaves_nothing()
    });
    if let Some(special) = special {
        let special = rivals.remove(special);
        rivals.insert(0, special);
    }
    Some(rivals)
}
