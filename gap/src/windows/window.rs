//! A prediction window with the state from which it begins.

use super::restart::Restart;
use std::ops::Range;

/// One prediction window.
#[derive(Clone, Debug)]
pub struct Window {
    /// Indices of the predicted samples.
    pub samples: Range<usize>,
    /// State at the begin of the prediction.
    pub restart: Restart,
    /// Standard deviation of the noise of a sample, in position units.
    pub noise: f64,
    /// Standard deviation of the noise of the samples to which the restart is fitted, in position units.
    pub restart_noise: f64,
}
