//! A place to fit from.

use crate::fit::hypothesis::Hypothesis;

/// Effects, and the coordinates of all that is free.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub hypothesis: Hypothesis,
    pub x: Vec<f64>,
}
