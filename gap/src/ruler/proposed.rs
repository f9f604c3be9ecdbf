//! Finds sets of effects that explain the missing torque.

use super::start::Start;
use crate::effects::{self, Candidate};
use crate::fit::Fit;
use crate::missing_torque::MissingTorque;
use crate::select::Search;
use crate::term::Term;
use host_sim::device::Device;

/// Number of sets that are requested from the missing torque.
const ASKED: usize = 8;
/// Largest number of these sets that are compared. Each costs a short fit.
const MEASURED: usize = 4;

/// Returns starts of the proposed sets on top of a `null` with free model parameters. An effect that only replaces one of these parameters
/// is left out.
pub(super) fn proposed(search: &Search<'_>, null: &Fit) -> Vec<Start> {
    let recording = search.problem.recording;
    let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
    let tried = search.tried(null, &[]);
    let is_free = |name: &str| {
        let number = effects::of(name).replaces();
        let mut free = search.problem.priors.iter();
        number.is_some_and(|number| free.any(|prior| prior.name == number))
    };
    let mut all: Vec<Start> = Vec::new();
    for proposal in missing.shortlist(ASKED) {
        let others = proposal.effects.iter().filter(|(name, _)| !is_free(name));
        let terms: Option<Vec<Term>> = others
            .map(|(name, values)| {
                let mut candidates = tried.iter();
                starting_at(candidates.find(|c| c.effect.name() == *name)?, values)
            })
            .collect();
        let Some(terms) = terms.filter(|terms| !terms.is_empty()) else {
            continue;
        };
        let mut hypothesis = null.hypothesis.clone();
        hypothesis.terms.extend(terms);
        let is_new = all
            .iter()
            .all(|start| start.hypothesis.names() != hypothesis.names());
        if is_new && all.len() < MEASURED {
            let mut x = null.x.clone();
            x.resize(hypothesis.dimensions(&search.problem.priors), 0.0);
            all.push(Start { hypothesis, x });
        }
    }
    all
}

/// Returns a start of an effect at the given values. Its form is the one whose free parameters are those that differ from their defaults.
fn starting_at(candidate: &Candidate, values: &[f64]) -> Option<Term> {
    let kind = candidate.effect.kind();
    let is_set = |place: usize| values[place] != kind.parameter(place).default;
    let suits = |term: &&Term| {
        let places = 0..values.len().min(term.values.len());
        places
            .filter(|&place| term.is_free(place) == is_set(place))
            .count()
    };
    let form = candidate.starts.iter().max_by_key(suits)?;
    let free = form.free.iter().filter(|c| c.parameter < values.len());
    let numbers: Vec<(usize, f64)> = free.map(|c| (c.parameter, values[c.parameter])).collect();
    Some(form.starting_at(&numbers))
}
