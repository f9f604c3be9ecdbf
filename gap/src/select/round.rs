//! A round of the search adds one effect to the model so far, and compares it with its rivals.

use super::acceptance::Acceptance;
use super::rival::Rival;
use super::search::FITTING_ITERATIONS;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;

/// One effect on top of the model so far, with its rivals.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// The model so far, without the effect of this round.
    pub known: Fit,
    /// All finalists. The winner is the first, and the others follow by their cost.
    pub rivals: Vec<Rival>,
    /// Every effect as fitted in screening.
    pub screened: Vec<Rival>,
    /// Whether the winner is accepted.
    pub acceptance: Acceptance,
    /// The model with all effects up to this one.
    pub so_far: Fit,
    /// Confidence and ties of the winner. They are present if sets of effects were compared.
    pub measured: Option<Measured>,
}

/// The result of a comparison of sets of effects with and without an effect.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// Probability that the effect is right.
    pub confidence: f64,
    /// Effects that explain as much in its place, within the standard error.
    pub ties: Vec<&'static str>,
}

impl Round {
    /// Returns the round fitted again on top of `known` after the effect at `place` was withdrawn.
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
