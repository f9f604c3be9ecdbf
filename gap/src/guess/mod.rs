//! First guesses: from what the recording shows, the sizes from which the fit of an effect starts.
//!
//! What is known of one effect stands with it in [`crate::effects`]; here is what several of them share.

pub(crate) mod balance;
pub(crate) mod late;
pub(crate) mod regression;
pub(crate) mod sliding;
pub(crate) mod start;
pub(crate) mod stay;
pub(crate) mod two_masses;
pub(crate) mod waves;

use crate::windows::motion::{Motion, Scales};
use crate::windows::series::Series;
use host_sim::device::Device;
use recording::Model;

/// What first guesses are made from.
pub(crate) struct Evidence<'a> {
    pub series: &'a [Series],
    pub motions: &'a [Motion],
    pub scales: &'a Scales,
    /// The device without the effect that is looked for.
    pub device: &'a Device,
    /// As it is stated.
    pub model: &'a Model,
    /// Of the low-pass that the position column has gone through, Hz.
    pub cutoff_hz: Option<f64>,
    /// Robust cost of each window without the effect, by running index.
    pub window_costs: &'a [f64],
}

impl Evidence<'_> {
    /// The largest input of the recording, either way.
    pub(crate) fn largest_input(&self) -> f64 {
        let largest = self.series.iter().map(|series| series.largest_input);
        largest.fold(0.0, f64::max)
    }

    /// True if the drive clips some of the input.
    pub(crate) fn clips_input(&self) -> bool {
        let mut inputs = self.series.iter().map(|series| series.largest_input);
        inputs.any(|input| self.device.drive.taken(input) < input)
    }
}
