//! Adds parts to an effect that may have several, such as a ripple of several orders.

use super::acceptance::stands_out;
use super::excess::level;
use super::search::{FITTING_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use rayon::prelude::*;

/// Returns a fit with as many parts of its last effect as each have a gain above chance.
pub(super) fn with_parts(search: &Search<'_>, mut fit: Fit) -> Fit {
    while let Some(more) = with_another_part(search, &fit) {
        if !stands_out(&more.costs.gains(&fit.costs), &search.expected) {
            break;
        }
        fit = more;
    }
    fit
}

/// Returns the fit of lowest cost with one more part of its last effect. Returns `None` if there is no start for another part.
fn with_another_part(search: &Search<'_>, fit: &Fit) -> Option<Fit> {
    let last = fit.last_term()?;
    let effect = effects::of(last.kind.name);
    let starts = search.evidence(fit, |beyond| effect.with_another_part(&last, beyond));
    let fits = starts.into_par_iter().map(|term| {
        let (hypothesis, x) = fit.with_last(term);
        search
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS)
    });
    fits.min_by(|a, b| level(a).total_cmp(&level(b)))
}
