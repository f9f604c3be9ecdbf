//! The torque of a drive over time, cut into steps.

use super::{Push, Torque};
use std::ops::Range;

/// Torque in steps that follow each other, each of some pieces.
#[derive(Clone, Debug)]
pub struct Course {
    pieces: Vec<(Torque, f64)>,
    steps: Vec<Step>,
    /// Of the pieces since the last step.
    open: Push,
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
            open: Push::NONE,
        }
    }
}

impl Course {
    /// A piece that acts for `lasts_s` after all that there is.
    #[inline]
    pub fn act(&mut self, torque: Torque, lasts_s: f64) {
        self.open = self.open.then(&Push::of(&torque, lasts_s));
        self.pieces.push((torque, lasts_s));
    }

    /// The same behind a lag, whose `decay` over `lasts_s`, exp(−t/lag), is known.
    #[inline]
    pub fn relax(&mut self, torque: Torque, lasts_s: f64, decay: f64) {
        self.open = self.open.then(&Push::behind(&torque, lasts_s, decay));
        self.pieces.push((torque, lasts_s));
    }

    /// Makes a step of the pieces since the last one.
    #[inline]
    pub fn close(&mut self) {
        self.step(self.open);
        self.open = Push::NONE;
    }

    /// A step of torques that are held, each in N m and for how long in s.
    #[inline(always)]
    pub fn hold(&mut self, pieces: impl IntoIterator<Item = (f64, f64)>) {
        let mut pieces = pieces.into_iter();
        let (torque_nm, lasts_s) = pieces.next().unwrap_or_default();
        let mut push = Push::held(torque_nm, lasts_s);
        if let Some((next_nm, next_s)) = pieces.next() {
            self.pieces.push((Torque::held(torque_nm), lasts_s));
            let mut next = (next_nm, next_s);
            loop {
                self.pieces.push((Torque::held(next.0), next.1));
                push = push.before(&Push::held(next.0, next.1));
                match pieces.next() {
                    Some(after) => next = after,
                    None => break,
                }
            }
        }
        self.step(push);
    }

    #[inline]
    fn step(&mut self, push: Push) {
        let end = self.pieces.len();
        self.steps.push(Step { push, end });
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

    /// What the pieces of a step come to.
    #[inline]
    pub(super) fn push(&self, step: usize) -> &Push {
        &self.steps[step].push
    }

    /// The pieces of a step; none where a torque is held.
    pub(super) fn pieces(&self, step: usize) -> &[(Torque, f64)] {
        let pieces: Range<usize> = self.start(step)..self.steps[step].end;
        &self.pieces[pieces]
    }
}
