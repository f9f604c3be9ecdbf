//! Selects the finalists, which are the effects that are fitted to all windows after screening.

use super::degenerate::is_degenerate;
use super::episode_search;
use super::excess::level;
use super::near_equivalents::near_equivalents;
use super::ranking::join_all;
use super::rival::{Rival, best_of};
use super::search::{FITTING_ITERATIONS, SHORT_ITERATIONS, Search};
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::stage::Stage;
use rayon::prelude::*;

/// Largest number of finalists, except for effects that act in few windows.
const FINALISTS: usize = 7;
/// Number of best effects of screening that are finalists whatever they gain.
const FEWEST_FINALISTS: usize = 3;
/// Largest difference to the best cost of screening, as a share of the best gain, for any other finalist. Of 409 winners on blind and other
/// sets all but one were within it.
const IN_REACH: f64 = 0.5;
/// Number of effects that act in few windows and may be finalists at any rank: the best ones.
const MOST_LOCAL: usize = 3;
/// Largest difference to the best cost, as a share of the best gain, at which the fit of a finalist is continued.
const NEAR: f64 = 0.3;
/// Number of best finalists whose fits are continued in any case.
const ALWAYS_NEAR: usize = 2;

/// Returns the finalists and the effects related to the best of them. All are fitted to all windows. Temporary effects near the best one
/// are in their best form.
pub(super) fn refit_shortlist(
    search: &Search<'_>,
    mut screened: Vec<Rival>,
    known: &Fit,
) -> Vec<Rival> {
    (search.progress)(Stage::Finalists);
    screened.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let fitted = |rivals: Vec<Rival>, iterations: usize| -> Vec<Rival> {
        let fits = rivals.into_par_iter().map(|rival| Rival {
            name: rival.name,
            fit: search
                .problem
                .fit(&rival.fit.hypothesis, rival.fit.x, Part::All, iterations),
        });
        fits.collect()
    };
    let mut local = 0;
    let all = screened.clone();
    let short_of = |best: f64, share: f64, none: f64| best + share * (none - best).max(0.0);
    // The worst cost in screening approximates the cost of `known` on these windows, because the worst effect closes nothing.
    let [best, worst] = [screened.first(), screened.last()]
        .map(|rival| rival.map_or(0.0, |rival| level(&rival.fit)));
    let limit = short_of(best, IN_REACH, worst);
    let finalists = screened.into_iter().enumerate().filter(|(rank, rival)| {
        let is_local = effects::of(rival.name).is_local();
        local += usize::from(is_local);
        let taken = *rank < FINALISTS || (is_local && local <= MOST_LOCAL);
        *rank < FEWEST_FINALISTS || (taken && level(&rival.fit) <= limit)
    });
    let mut rivals = fitted(
        finalists.map(|(_, rival)| rival).collect(),
        SHORT_ITERATIONS,
    );
    rivals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let best = rivals.first().map_or(level(known), |r| level(&r.fit));
    let limit = short_of(best, NEAR, level(known));
    let near = rivals
        .iter()
        .take_while(|rival| level(&rival.fit) <= limit)
        .count();
    let far = rivals.split_off(near.max(ALWAYS_NEAR).min(rivals.len()));
    let near = fitted(rivals, FITTING_ITERATIONS).into_par_iter();
    let completed = near.map(|rival| Rival {
        fit: episode_search::completed(search.problem, &search.expected, rival.fit),
        name: rival.name,
    });
    let mut rivals: Vec<Rival> = completed.collect();
    rivals.extend(far);
    if let Some(best) = best_of(&rivals) {
        let related = related(search, best, &all);
        join_all(&mut rivals, related);
    }
    rivals
}

/// Returns the special cases and near-equivalents of a rival among the `screened` rivals. Each is fitted from the parameters of the rival.
fn related(search: &Search<'_>, to: &Rival, screened: &[Rival]) -> Vec<Rival> {
    let related = near_equivalents(to, screened, &search.problem.recording.model)
        .into_par_iter()
        .map(|rival| {
            let Fit { hypothesis, x, .. } = rival.fit;
            Rival {
                name: rival.name,
                fit: search
                    .problem
                    .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS),
            }
        });
    related.filter(|r| !is_degenerate(search, &r.fit)).collect()
}
