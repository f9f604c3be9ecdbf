//! What touches the device from outside for a while.

use super::{Motion, Stop};

/// Something soft that is there in one run, for a while.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub run: usize,
    pub from_s: f64,
    pub to_s: f64,
    pub body: Stop,
    /// True if it pulls as well, as a hand does that has closed.
    pub grips: bool,
}

/// What a hand takes to close and to open, s.
const CLOSING_S: f64 = 0.02;

impl Contact {
    /// Torque on the device in `run` at the session's `time_s`.
    pub fn torque(&self, motion: Motion, run: usize, time_s: f64) -> f64 {
        if run != self.run || !(self.from_s..self.to_s).contains(&time_s) {
            0.0
        } else if self.grips {
            let closed = (time_s - self.from_s).min(self.to_s - time_s) / CLOSING_S;
            let pull =
                self.body.stiffness * (motion.x - self.body.at) + self.body.damping * motion.v;
            -closed.min(1.0) * pull
        } else {
            self.body.torque(motion)
        }
    }
}

/// A torque from outside for a moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub run: usize,
    pub from_s: f64,
    pub to_s: f64,
    /// N m.
    pub torque: f64,
}

impl Push {
    /// Torque on the device in `run` at the session's `time_s`.
    pub fn torque(&self, run: usize, time_s: f64) -> f64 {
        let is_there = run == self.run && (self.from_s..self.to_s).contains(&time_s);
        if is_there { self.torque } else { 0.0 }
    }
}
