//! Contacts and pushes from outside that last for a while.

use super::{Motion, Stop};

/// A soft object that touches the device during part of one run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub run: usize,
    pub from_s: f64,
    pub to_s: f64,
    pub body: Stop,
    /// If true, it pulls as well as pushes, like a hand that holds the device.
    pub grips: bool,
}

/// Time that a hand takes to close or to open, s.
const CLOSING_S: f64 = 0.02;

impl Contact {
    /// Torque on the device in `run` at `time_s` of the session.
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

/// An external torque for a short time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub run: usize,
    pub from_s: f64,
    pub to_s: f64,
    /// N m.
    pub torque: f64,
}

impl Push {
    /// Torque on the device in `run` at `time_s` of the session.
    pub fn torque(&self, run: usize, time_s: f64) -> f64 {
        let is_there = run == self.run && (self.from_s..self.to_s).contains(&time_s);
        if is_there { self.torque } else { 0.0 }
    }
}
