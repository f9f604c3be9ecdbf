//! What is not linear.

use super::super::Plant;
use super::super::pendulum::Pendulum;

/// What acts on one side, its linear part and friction that is [level](super::level) apart.
pub(super) struct Bent<'a> {
    plant: &'a Plant,
    side: usize,
    direction: f64,
    /// True if friction depends on position, speed or load.
    pub(super) varies: bool,
}

impl<'a> Bent<'a> {
    pub(super) fn of(plant: &'a Plant, side: usize, direction: f64) -> Self {
        Self {
            plant,
            side,
            direction,
            varies: !plant.is_level && direction != 0.0,
        }
    }

    /// Drag beyond the viscous one, and friction that varies, N m.
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

    /// N m.
    #[inline]
    pub(super) fn motor(&self, position: f64, velocity: f64, time_s: f64, drive_nm: f64) -> f64 {
        let mut torque = -self.resists(position, velocity, time_s, drive_nm);
        if self.plant.parts.has_cogging {
            torque += self.plant.parts.cogging.torque(position);
        }
        torque
    }

    /// Where the load is, N m.
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
