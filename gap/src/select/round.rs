//! One effect on top of what was known, as a round of the search found it.

use super::acceptance::Acceptance;
use super::excess::level;
use super::rival::Rival;
use super::search::FITTING_ITERATIONS;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;

/// One effect on top of what was known, with what stood beside it.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// What was known without it.
    pub known: Fit,
    /// All finalists, the winner first, the others by what they leave.
    pub rivals: Vec<Rival>,
    /// Every effect as screening left it.
    pub screened: Vec<Rival>,
    /// Whether the winner is better than what was known.
    pub acceptance: Acceptance,
    /// The model with the effects up to this one.
    pub so_far: Fit,
    /// What is known of the winner where it was measured beside all other effects.
    pub measured: Option<Measured>,
}

/// What measuring an effect beside all others of its set says of it.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// Probability that it is right.
    pub confidence: f64,
    /// Effects in whose place it costs no less, within the error.
    pub ties: Vec<&'static str>,
}

impl Round {
    /// True if a fit leaves less than its winner does.
    pub(super) fn leaves_more_than(&self, fit: &Fit) -> bool {
        level(fit) < level(&self.rivals[0].fit)
    }

    /// The same on top of what is `known` without one of the effects before it.
    pub(super) fn without(&self, problem: &Problem<'_>, place: usize, known: Fit) -> Self {
        let (hypothesis, x) = self.so_far.without(place);
        let fit = problem.fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Self {
            known,
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: self.rivals[0].name,
                fit,
            }],
            screened: Vec::new(),
            acceptance: self.acceptance,
            measured: self.measured.clone(),
        }
    }
}
