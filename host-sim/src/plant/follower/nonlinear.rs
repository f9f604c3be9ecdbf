//! The nonlinear part of the torque.

use super::super::Plant;
use super::super::pendulum::Pendulum;

/// Nonlinear torque on one side, without dry friction of a [constant level](super::friction_level).
pub(super) struct Nonlinear<'a> {
    plant: &'a Plant,
    side: usize,
    direction: f64,
    /// True if friction depends on position, speed or load.
    pub(super) varies: bool,
}

impl<'a> Nonlinear<'a> {
    pub(super) fn of(plant: &'a Plant, side: usize, direction: f64) -> Self {
        Self {
            plant,
            side,
            direction,
            varies: !plant.is_level && direction != 0.0,
        }
    }

    /// Quadratic drag, and dry friction that varies, N m.
    #[inline]
    pub(super) fn resists(&self, position: f64, velocity: f64, time_s: f64, drive_nm: f64) -> f64 {
        let m = &self.plant.mechanics;
        let share = self.plant.friction_share[self.side];
        let mut torque = m.drag * velocity.abs() * velocity;
        if self.varies {
            let speed = velocity.abs();
            let level = m.sliding(self.direction, position, speed, time_s, drive_nm);
            torque += self.direction * level;
        }
        share * torque
    }

    /// Torque on the motor side, N m.
    #[inline]
    pub(super) fn motor(&self, position: f64, velocity: f64, time_s: f64, drive_nm: f64) -> f64 {
        let mut torque = -self.resists(position, velocity, time_s, drive_nm);
        if self.plant.parts.has_cogging {
            torque += self.plant.parts.cogging.torque(position);
        }
        torque
    }

    /// Torque on the load side, N m.
    #[inline]
    pub(super) fn load(&self, pendulum: &mut Pendulum, position: f64) -> f64 {
        let m = &self.plant.mechanics;
        let hardened = m.hardened(position);
        if m.gravity == 0.0 {
            return hardened;
        }
        let angle = m.from_hanging_rad(position);
        pendulum.follow(angle);
        hardened - m.gravity * pendulum.sin(angle)
    }
}
