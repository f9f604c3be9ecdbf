//! The torque profile of a drive: its torque over time, in steps.

use super::torque::Impulse;
use super::{Cascade, Push, Torque};

/// A torque profile: steps that follow each other, each made of pieces.
#[derive(Clone, Debug)]
pub struct TorqueProfile {
    pieces: Vec<(Torque, f64)>,
    steps: Vec<Step>,
    /// Impulse of the pieces since the last step.
    open: Impulse,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    push: Push,
    /// Index behind its last piece.
    end: usize,
}

impl Default for TorqueProfile {
    fn default() -> Self {
        Self {
            pieces: Vec::new(),
            steps: Vec::new(),
            open: Impulse::NONE,
        }
    }
}

impl TorqueProfile {
    /// An empty profile with room for `steps` steps of `pieces` pieces each.
    pub fn with_room(steps: usize, pieces: usize) -> Self {
        Self {
            pieces: Vec::with_capacity(steps * pieces),
            steps: Vec::with_capacity(steps),
            ..Self::default()
        }
    }

    /// Appends a torque that acts for `lasts_s`.
    #[inline]
    pub fn act(&mut self, torque: Torque, lasts_s: f64) {
        self.open = self.open.then(&Impulse::of(&torque, lasts_s));
        self.pieces.push((torque, lasts_s));
    }

    /// Appends a torque behind a lag that acts for `lasts_s`. `decay` is exp(−`lasts_s`/lag).
    #[inline]
    pub fn relax(&mut self, torque: Torque, lasts_s: f64, decay: f64) {
        self.open = self.open.then(&Impulse::behind(&torque, lasts_s, decay));
        self.pieces.push((torque, lasts_s));
    }

    /// Appends a torque behind two lags that acts for `lasts_s`. `decays` are exp(−`lasts_s`/lag) of each.
    #[inline]
    pub fn relax_twice(&mut self, cascade: &Cascade, lasts_s: f64, decays: [f64; 2]) {
        self.open = self.open.then(&cascade.impulse(lasts_s, decays));
        self.pieces.push((cascade.torque(lasts_s, decays), lasts_s));
    }

    /// Ends a step: it consists of the pieces since the last one.
    #[inline]
    pub fn close(&mut self) {
        self.steps.push(Step {
            push: self.open.push(),
            end: self.pieces.len(),
        });
        self.open = Impulse::NONE;
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    #[inline]
    fn start(&self, step: usize) -> usize {
        step.checked_sub(1)
            .map_or(0, |before| self.steps[before].end)
    }

    /// Sum of the pieces of a step; `None` beyond the last one.
    #[inline(always)]
    pub(super) fn push(&self, step: usize) -> Option<&Push> {
        self.steps.get(step).map(|step| &step.push)
    }

    /// The pieces of a step.
    pub(super) fn pieces(&self, step: usize) -> &[(Torque, f64)] {
        &self.pieces[self.start(step)..self.steps[step].end]
    }
}
