//! A start of a fit.

use crate::fit::hypothesis::Hypothesis;

/// A hypothesis, and the coordinates of its free parameters and of the free model parameters.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub hypothesis: Hypothesis,
    pub x: Vec<f64>,
}
