//! An effect that consists of several parts, such as a ripple of several orders.

use super::acceptance::stands_out;
use super::excess::level;
use super::search::{FITTING_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use rayon::prelude::*;

/// A fit with as many parts of its last effect as each gain more than chance.
pub(super) fn with_parts(search: &Search<'_>, mut fit: Fit) -> Fit {
    while let Some(more) = with_another_part(search, &fit) {
        if !stands_out(&more.costs.gains(&fit.costs), &search.expected) {
            break;
        }
        fit = more;
    }
    fit
}

/// The best fit with one more part.
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
