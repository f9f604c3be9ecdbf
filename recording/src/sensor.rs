//! Properties of a position sensor.

use core::f64::consts::TAU;
use serde::{Deserialize, Serialize};

/// A position sensor: noise, quantisation, and a low-pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Quantum, in units of position. 0 is continuous.
    #[serde(default)]
    pub resolution: f64,
    /// Standard deviation of the noise before quantisation, in units of position.
    #[serde(default)]
    pub noise: f64,
    /// Corner frequency of the first-order low-pass in the logged column, Hz. `None` is no low-pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff_hz: Option<f64>,
}

impl Sensor {
    /// Standard deviation of noise and quantisation error together, in units of position.
    pub fn deviation(&self) -> f64 {
        (self.noise.powi(2) + self.resolution.powi(2) / 12.0).sqrt()
    }
}

/// Gain a of the first-order low-pass `y += a (x − y)` for a sampling period. 1 without a low-pass.
pub fn low_pass_gain(cutoff_hz: Option<f64>, period_s: f64) -> f64 {
    cutoff_hz.map_or(1.0, |cutoff_hz| (TAU * cutoff_hz * period_s).min(1.0))
}
