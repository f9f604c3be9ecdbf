//! The integration of a state over a torque profile.

use super::super::{Mechanics, Plant, Push, State, TorqueProfile};

/// A state, the steps of the profile that are still to be taken, and the sensor's position after each step.
pub(super) struct Integration<'a> {
    mechanics: &'a Mechanics,
    pub(super) state: &'a mut State,
    profile: &'a TorqueProfile,
    /// Factor of the profile's torque.
    gain: f64,
    next: usize,
    seen: &'a mut [f64],
}

impl<'a> Integration<'a> {
    pub(super) fn new(
        plant: &'a Plant,
        state: &'a mut State,
        profile: &'a TorqueProfile,
        gain: f64,
        seen: &'a mut [f64],
    ) -> Self {
        Self {
            mechanics: plant.mechanics(),
            state,
            profile,
            gain,
            next: 0,
            seen,
        }
    }

    /// Index of the next step.
    #[inline]
    pub(super) fn next(&self) -> usize {
        self.next
    }

    #[inline]
    pub(super) fn is_over(&self) -> bool {
        self.next >= self.profile.steps()
    }

    /// Torque and duration of the next step, if there is one.
    #[inline(always)]
    pub(super) fn push(&self) -> Option<Push> {
        let push = self.profile.push(self.next)?.scaled(self.gain);
        if self.mechanics.laws.is_empty() {
            return Some(push);
        }
        let State {
            position,
            velocity,
            time_s,
            ..
        } = *self.state;
        let motion = [position, velocity];
        let by_laws = self
            .mechanics
            .by_laws(motion, push.means_nm[0], time_s, push.lasts_s);
        Some(push.beside(by_laws))
    }

    /// Ends the next step. `seen` is the sensor's position after it.
    #[inline]
    pub(super) fn step(&mut self, push: &Push, seen: f64) {
        self.state.time_s += push.lasts_s;
        self.seen[self.next] = seen;
        self.next += 1;
    }

    /// Integrates the next step by the general method, which handles every event.
    pub(super) fn by_pieces(&mut self, plant: &Plant) {
        for &(torque, piece_s) in self.profile.pieces(self.next) {
            plant.advance(self.state, torque.scaled(self.gain), piece_s);
        }
        self.seen[self.next] = plant.seen(self.state).0;
        self.next += 1;
    }
}
