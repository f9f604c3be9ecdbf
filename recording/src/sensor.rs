//! What is known of a position sensor.

use core::f64::consts::TAU;
use serde::{Deserialize, Serialize};

/// A position sensor: noise and quantising, and a low-pass before or after them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Quantum, in units of position; 0 is continuous.
    #[serde(default)]
    pub resolution: f64,
    /// Standard deviation of what is added before quantising, in units of position.
    #[serde(default)]
    pub noise: f64,
    /// Corner of the first-order low-pass that is already in the logged column, Hz; `None` is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff_hz: Option<f64>,
}

impl Sensor {
    /// Standard deviation of what noise and quantising add to a reading, in units of position.
    pub fn deviation(&self) -> f64 {
        (self.noise.powi(2) + self.resolution.powi(2) / 12.0).sqrt()
    }
}

/// Gain a of the format's first-order low-pass `y += a (x − y)` over a period, 1 without a corner.
pub fn low_pass_gain(cutoff_hz: Option<f64>, period_s: f64) -> f64 {
    cutoff_hz.map_or(1.0, |cutoff_hz| (TAU * cutoff_hz * period_s).min(1.0))
}
