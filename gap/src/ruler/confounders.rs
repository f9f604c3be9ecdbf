//! Finds effects that may be present in place of the one that was found.

use super::pool::SHORT_ITERATIONS;
use super::start::Start;
use crate::effects::{self, Candidate, Identification};
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::select::Search;
use crate::term::Term;
use rayon::prelude::*;

/// Number of starts of each effect that are fitted with few iterations: those of the lowest cost.
const MOST_STARTS: usize = 3;

/// Returns copies of a set of effects in which one effect beyond the first `kept` is exchanged for another one. The other effect changes
/// small motion in nearly the same way, contains the exchanged one as a special case, or is a special case of it.
pub(super) fn of(search: &Search<'_>, set: &Fit, kept: usize) -> Vec<Start> {
    let names = set.hypothesis.names();
    let places = kept..set.hypothesis.terms.len();
    let exchanged = places.flat_map(|place| {
        let mut known = set.clone();
        (known.hypothesis, known.x) = set.without(place);
        let exchanged = exchanged(search, set, place, &known);
        exchanged
            .into_iter()
            .map(move |starts| (known.clone(), starts))
            .collect::<Vec<_>>()
    });
    let exchanged: Vec<(Fit, Vec<Term>)> = exchanged.collect();
    let fits = exchanged.par_iter().filter_map(|(known, starts)| {
        let at_once = starts.par_iter().map(|start| {
            let mut hypothesis = known.hypothesis.clone();
            hypothesis.terms.push(start.clone());
            let mut x = known.x.clone();
            x.resize(hypothesis.dimensions(&search.problem.priors), 0.0);
            let level = search.problem.costs(&hypothesis, &x, Part::All).level();
            (level, hypothesis, x)
        });
        let mut at_once: Vec<(f64, Hypothesis, Vec<f64>)> = at_once.collect();
        at_once.sort_by(|a, b| a.0.total_cmp(&b.0));
        at_once.truncate(MOST_STARTS);
        let fits = at_once.into_par_iter().map(|(_, hypothesis, x)| {
            let iterations = SHORT_ITERATIONS;
            search.problem.fit(&hypothesis, x, Part::All, iterations)
        });
        let best = fits.min_by(|a, b| a.costs.level().total_cmp(&b.costs.level()))?;
        Some(crate::select::episode_search::completed(
            search.problem,
            &search.expected,
            best,
        ))
    });
    let fits: Vec<Fit> = fits.collect();
    let new = fits
        .into_iter()
        .filter(|fit| fit.hypothesis.names() != names);
    let starts = new.map(|fit| Start {
        hypothesis: fit.hypothesis,
        x: fit.x,
    });
    starts.collect()
}

/// Returns the effects for which the one at a place may be exchanged. Each is a list of starts of its fit beside the other effects, which
/// are `known`.
fn exchanged(search: &Search<'_>, set: &Fit, place: usize, known: &Fit) -> Vec<Vec<Term>> {
    let model = &search.problem.recording.model;
    let Some((term, x)) = set.hypothesis.parts(&set.x).nth(place) else {
        return Vec::new();
    };
    let own = effects::of(term.kind.name);
    let on_small_motion = own.on_small_motion(&term.moved(x), model);
    let confounds = |candidate: &&Candidate| {
        let other = candidate.effect;
        other.name() != own.name() && are_confounded(own, other)
    };
    let tried = search.tried(known, &[]);
    let starts = tried.iter().filter(confounds).map(|candidate| {
        let first = candidate.starts.first();
        let alike = on_small_motion.zip(first);
        let alike = alike
            .and_then(|(motion, first)| candidate.effect.equivalent_start(first, motion, model));
        let starts = alike.into_iter().chain(candidate.starts.iter().cloned());
        starts.collect()
    });
    starts.collect()
}

fn are_confounded(one: &'static dyn Identification, other: &'static dyn Identification) -> bool {
    let is_kin = one.family().is_some() && one.family() == other.family();
    is_kin || one.contains(other.name()) || other.contains(one.name())
}
