//! What touches the device from outside for a while.

use super::{Motion, Stop};

/// Something soft that is there in one run, for a while.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub run: usize,
    pub from_s: f64,
    pub to_s: f64,
    pub body: Stop,
}

impl Contact {
    /// Torque on the device in `run` at the session's `time_s`.
    pub fn torque(&self, motion: Motion, run: usize, time_s: f64) -> f64 {
        if run == self.run && (self.from_s..self.to_s).contains(&time_s) {
            self.body.torque(motion)
        } else {
            0.0
        }
    }
}
