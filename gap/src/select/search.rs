//! Holds what all steps of a search use: the data, the results that are known before it, and the expected cost of an exact model.

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

/// Number of iterations of the fits of all finalists.
pub(super) const SHORT_ITERATIONS: usize = 3;
/// Number of iterations of the continued fits of finalists near the best one.
pub(super) const FITTING_ITERATIONS: usize = 8;
/// Number of iterations of the last fits of the winner.
pub(super) const POLISHING_ITERATIONS: usize = 15;

/// Results that are known before the search.
#[derive(Clone)]
pub(crate) struct Given<'a> {
    /// True if the gap of the nominal model exceeds its floor.
    pub is_gap: bool,
    /// Names of effects that are known to be absent or that the user excludes.
    pub excluded: Vec<&'a str>,
    /// An effect whose parameters follow from a comparison of two position columns. It is tried from these parameters only.
    pub measured: Option<Term>,
    /// True if that effect is certainly present.
    pub certain: bool,
}

#[cfg(test)]
impl Given<'_> {
    /// The nominal model has a gap, and nothing else is known.
    pub(crate) const A_GAP: Self = Self {
        is_gap: true,
        excluded: Vec::new(),
        measured: None,
        certain: false,
    };
}

/// The data and functions that all rounds of a search use.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub given: &'a Given<'a>,
    /// Called at the beginning of each stage.
    pub progress: fn(Stage),
    pub expected: ExpectedLoss,
}

impl Search<'_> {
    /// Returns the highest cost per window of an adequate model.
    pub(super) fn adequate_level(&self) -> f64 {
        self.expected.level + ADEQUATE_EXCESS
    }

    pub(super) fn has_two_masses(&self, fit: &Fit) -> bool {
        let predictor = self.problem.predictor(&fit.hypothesis, &fit.x);
        predictor.device().mechanics.link.is_some()
    }

    /// Calls `told` with the evidence in the data beyond the model `known`.
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

    /// Returns the effects that the model `known` does not have, with the starts of their fits. For an effect that would be scanned, the
    /// fit in `hints` is the only start.
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

/// Returns the robust cost of each window.
pub(super) fn window_costs(problem: &Problem<'_>, fit: &Fit) -> Vec<f64> {
    (0..problem.window_count())
        .map(|w| fit.costs.log(w))
        .collect()
}

/// Returns the value of `look` for a search of one more effect on top of the nominal model.
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
