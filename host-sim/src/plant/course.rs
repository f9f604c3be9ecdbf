//! The torque of a drive over time, cut into steps.

use super::torque::Impulse;
use super::{Cascade, Push, Torque};

/// Torque in steps that follow each other, each of some pieces.
#[derive(Clone, Debug)]
pub struct Course {
    pieces: Vec<(Torque, f64)>,
    steps: Vec<Step>,
    /// Of the pieces since the last step.
    open: Impulse,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    push: Push,
    /// One past its last piece.
    end: usize,
}

impl Default for Course {
    fn default() -> Self {
        Self {
            pieces: Vec::new(),
            steps: Vec::new(),
            open: Impulse::NONE,
        }
    }
}

impl Course {
    /// Empty, with room for so many steps of so many pieces each.
    pub fn with_room(steps: usize, pieces: usize) -> Self {
        Self {
            pieces: Vec::with_capacity(steps * pieces),
            steps: Vec::with_capacity(steps),
            ..Self::default()
        }
    }

    /// A piece that acts for `lasts_s` after all that there is.
    #[inline]
    pub fn act(&mut self, torque: Torque, lasts_s: f64) {
        self.open = self.open.then(&Impulse::of(&torque, lasts_s));
        self.pieces.push((torque, lasts_s));
    }

    /// The same behind a lag, whose `decay` over `lasts_s`, exp(−t/lag), is known.
    #[inline]
    pub fn relax(&mut self, torque: Torque, lasts_s: f64, decay: f64) {
        self.open = self.open.then(&Impulse::behind(&torque, lasts_s, decay));
        self.pieces.push((torque, lasts_s));
    }

    /// The same behind two lags, with the decay of each.
    #[inline]
    pub fn relax_twice(&mut self, cascade: &Cascade, lasts_s: f64, decays: [f64; 2]) {
        self.open = self.open.then(&cascade.impulse(lasts_s, decays));
        self.pieces.push((cascade.torque(lasts_s, decays), lasts_s));
    }

    /// Makes a step of the pieces since the last one.
    #[inline]
    pub fn close(&mut self) {
        self.steps.push(Step {
            push: self.open.push(),
            end: self.pieces.len(),
        });
        self.open = Impulse::NONE;
    }

    /// How many steps there are.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    #[inline]
    fn start(&self, step: usize) -> usize {
        step.checked_sub(1)
            .map_or(0, |before| self.steps[before].end)
    }

    /// What the pieces of a step come to, if there is one.
    #[inline(always)]
    pub(super) fn push(&self, step: usize) -> Option<&Push> {
        self.steps.get(step).map(|step| &step.push)
    }

    /// The pieces of a step.
    pub(super) fn pieces(&self, step: usize) -> &[(Torque, f64)] {
        &self.pieces[self.start(step)..self.steps[step].end]
    }
}
