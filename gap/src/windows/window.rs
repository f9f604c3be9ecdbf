//! One stretch of prediction, with the state from which it begins.

use super::restart::Restart;
use std::ops::Range;

/// One prediction window.
#[derive(Clone, Debug)]
pub struct Window {
    /// Samples that are predicted.
    pub samples: Range<usize>,
    /// State from which they are.
    pub restart: Restart,
    /// Standard deviation of a sample here, in units of position.
    pub noise: f64,
    /// That of the samples that the restart is fitted to.
    pub restart_noise: f64,
}
