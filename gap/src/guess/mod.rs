//! Start values: estimates of the parameters of an effect from the recording, from which its fit begins.
//!
//! The start values of a single effect stand with the effect in [`crate::effects`]. This folder holds the methods that several effects
//! share.

pub(crate) mod balance;
pub(crate) mod contact;
pub(crate) mod delays;
pub(crate) mod regression;
pub(crate) mod sliding;
pub(crate) mod start;
pub(crate) mod two_masses;
pub(crate) mod waves;

use crate::windows::motion::{Motion, Scales};
use crate::windows::series::Series;
use host_sim::device::Device;
use recording::Model;

/// The data for start values.
pub(crate) struct Evidence<'a> {
    pub series: &'a [Series],
    pub motions: &'a [Motion],
    pub scales: &'a Scales,
    /// The device without the effect that is fitted.
    pub device: &'a Device,
    /// The model as stated.
    pub model: &'a Model,
    /// Cutoff frequency of the low-pass that the position column has passed through, Hz.
    pub cutoff_hz: Option<f64>,
    /// Robust cost of each window without the effect, by running index.
    pub window_costs: &'a [f64],
}

impl Evidence<'_> {
    /// The largest magnitude of the input in the recording.
    pub(crate) fn largest_input(&self) -> f64 {
        let largest = self.series.iter().map(|series| series.largest_input);
        largest.fold(0.0, f64::max)
    }

    /// True if the drive of the model limits some of the input.
    pub(crate) fn clips_input(&self) -> bool {
        let mut inputs = self.series.iter().map(|series| series.largest_input);
        inputs.any(|input| self.device.drive.taken(input) < input)
    }
}
