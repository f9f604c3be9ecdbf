//! Torque on the load side that is linear in its position and velocity: that of the spring and of barriers in contact.

use super::{Barrier, Plant, State, Touch};

/// `T = constant − stiffness · x − damping · v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearLoad {
    /// Torque at position 0 and velocity 0, N m.
    pub(super) constant_nm: f64,
    /// Stiffness, N m/rad.
    pub(super) stiffness: f64,
    /// Damping, N m s/rad.
    pub(super) damping: f64,
    /// True if a barrier is in contact.
    pub(super) pushes: bool,
}

impl LinearLoad {
    pub(super) fn of(plant: &Plant, state: &State) -> Self {
        let m = &plant.mechanics;
        let spring = Self {
            constant_nm: m.stiffness * m.stiffness_zero,
            stiffness: m.stiffness,
            damping: 0.0,
            pushes: false,
        };
        let barriers = plant.parts.barriers.iter().zip(&state.touch);
        let pushing = barriers.filter(|(_, touch)| **touch == Touch::Pushing);
        pushing.fold(spring, |linear_load, (barrier, _)| linear_load.and(barrier))
    }

    fn and(self, barrier: &Barrier) -> Self {
        Self {
            constant_nm: self.constant_nm + barrier.torque_nm + barrier.stiffness * barrier.at,
            stiffness: self.stiffness + barrier.stiffness,
            damping: self.damping + barrier.damping,
            pushes: true,
        }
    }

    /// Natural frequency plus damping of an inertia under this load, 1/s.
    pub(super) fn rate(&self, inverse_inertia: f64) -> f64 {
        (self.stiffness.abs() * inverse_inertia).sqrt() + self.damping * inverse_inertia
    }
}
