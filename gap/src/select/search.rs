//! What all steps of a search share: the data, what is known before it, and the expected cost of an exact model.

use super::excess::ADEQUATE_EXCESS;
use super::rival::Rival;
use crate::effects::{Candidate, candidates};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::ExpectedLoss;
use crate::guess::Evidence;
use crate::stage::Stage;
use crate::term::Term;
use crate::windows::motion::{Motion, Scales};
use rayon::prelude::*;

/// Iterations of a fit: of all finalists, of those that are then near the best, and of the one that is named.
pub(super) const SHORT_ITERATIONS: usize = 3;
pub(super) const FITTING_ITERATIONS: usize = 8;
pub(super) const POLISHING_ITERATIONS: usize = 15;

/// What is known before the search.
#[derive(Clone)]
pub(crate) struct Given<'a> {
    /// True if the gap of the nominal model exceeds its floor.
    pub is_gap: bool,
    /// Names of effects that are known to be absent, or that the user does not want tried.
    pub excluded: Vec<&'a str>,
    /// An effect whose size two position columns show: it is tried at this size alone.
    pub measured: Option<Term>,
    /// True if that effect is present beyond doubt.
    pub certain: bool,
}

#[cfg(test)]
impl Given<'_> {
    /// That there is a gap.
    pub(crate) const A_GAP: Self = Self {
        is_gap: true,
        excluded: Vec::new(),
        measured: None,
        certain: false,
    };
}

/// What all rounds of a search share.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub given: &'a Given<'a>,
    /// Told of each stage.
    pub progress: fn(Stage),
    pub expected: ExpectedLoss,
}

impl Search<'_> {
    /// Robust cost up to which a model is adequate.
    pub(super) fn adequate_level(&self) -> f64 {
        self.expected.level + ADEQUATE_EXCESS
    }

    pub(super) fn has_two_masses(&self, fit: &Fit) -> bool {
        let predictor = self.problem.predictor(&fit.hypothesis, &fit.x);
        predictor.device().mechanics.link.is_some()
    }

    /// Calls `told` with what the data show beyond the model `known`.
    pub(crate) fn evidence<T>(&self, known: &Fit, told: impl FnOnce(&Evidence<'_>) -> T) -> T {
        let Problem {
            recording, series, ..
        } = self.problem;
        let device = known
            .hypothesis
            .device(&recording.model, &self.problem.priors, &known.x);
        let cutoff_hz = recording.sensor("position").cutoff_hz;
        let half_width_s = recording.restart_half_width;
        let motions = series.par_iter();
        let motions = motions.map(|s| Motion::of(s, &device, cutoff_hz, half_width_s));
        let motions: Vec<Motion> = motions.collect();
        told(&Evidence {
            series,
            motions: &motions,
            scales: &Scales::of(series, &motions, &device, recording.horizon),
            device: &device,
            model: &recording.model,
            cutoff_hz,
            window_costs: &window_costs(self.problem, known),
        })
    }

    /// The effects that the model `known` does not have, with the places from which to fit them. A `hint` is the only start of an effect
    /// that would otherwise be scanned.
    pub(crate) fn tried(&self, known: &Fit, hints: &[Rival]) -> Vec<Candidate> {
        let mut tried = self.evidence(known, candidates);
        let terms = &known.hypothesis.terms;
        tried.retain(|candidate| {
            let name = candidate.effect.name();
            !self.given.excluded.contains(&name) && terms.iter().all(|term| term.kind.name != name)
        });
        for candidate in &mut tried {
            let name = candidate.effect.name();
            let measured = self.given.measured.as_ref().filter(|t| t.kind.name == name);
            let hint = hints.iter().find(|hint| hint.name == name);
            let hint = hint.filter(|_| candidate.effect.landscape().is_scanned());
            if let Some(start) = measured.cloned().or_else(|| hint?.fit.last_term()) {
                candidate.starts = vec![start];
            }
        }
        tried
    }
}

/// Robust cost of each window.
pub(super) fn window_costs(problem: &Problem<'_>, fit: &Fit) -> Vec<f64> {
    (0..problem.window_count())
        .map(|w| fit.costs.log(w))
        .collect()
}

/// What a search for one more effect on top of a bare nominal model comes to.
#[cfg(test)]
pub(super) fn on<T>(
    recording: &recording::Recording,
    look: impl FnOnce(&Search<'_>, &Fit) -> T,
) -> T {
    let problem = crate::made::problem(recording);
    let bare = crate::fit::hypothesis::Hypothesis { terms: Vec::new() };
    let null = problem.fit(&bare, Vec::new(), crate::fit::part::Part::All, 0);
    let search = Search {
        problem: &problem,
        given: &Given::A_GAP,
        progress: |_| {},
        expected: ExpectedLoss::of(&problem, &null).bounded(),
    };
    look(&search, &null)
}
