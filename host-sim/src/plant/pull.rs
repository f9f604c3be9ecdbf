//! The torques on the motor side and on the load side of the joint, without dry friction.

use super::pendulum::Pendulum;
use super::{BARRIERS, Mechanics, Plant, State, Touch};

impl Mechanics {
    /// Viscous friction and quadratic drag, N m.
    #[inline(always)]
    pub(super) fn drag(&self, velocity: f64) -> f64 {
        (self.viscous + self.drag * velocity.abs()) * velocity
    }

    /// Level of dry friction against motion in `direction` (±1) under a drive, N m.
    #[inline]
    pub(super) fn sliding(
        &self,
        direction: f64,
        position: f64,
        speed: f64,
        time_s: f64,
        drive_nm: f64,
    ) -> f64 {
        let transmitted_nm = self.transmitted(drive_nm, position);
        self.friction
            .sliding(direction, position, speed, time_s, transmitted_nm)
    }

    /// Level that holds against a push in `direction` (±1) at rest under a drive, N m.
    #[inline]
    pub(super) fn holding(&self, direction: f64, position: f64, time_s: f64, drive_nm: f64) -> f64 {
        let transmitted_nm = self.transmitted(drive_nm, position);
        self.friction
            .holding(direction, position, time_s, transmitted_nm)
    }

    /// Torque that the transmission carries under a drive, N m. Dry friction may grow with it.
    #[inline]
    fn transmitted(&self, drive_nm: f64, position: f64) -> f64 {
        let passive = self.friction.load_passive;
        if passive == 0.0 {
            return drive_nm;
        }
        drive_nm + passive * self.passive(position)
    }

    /// Torque of gravity and springs at a position, N m.
    #[inline]
    pub fn passive(&self, position: f64) -> f64 {
        self.spring(position) - self.gravity * self.from_hanging_rad(position).sin()
    }
}

impl Plant {
    /// Torque on the motor side without friction and link, N m.
    #[inline(always)]
    pub(super) fn motor_side(&self, drive_nm: f64, position: f64) -> f64 {
        let torque = drive_nm + self.mechanics.offset_nm;
        if self.parts.has_cogging {
            torque + self.parts.cogging.torque(position)
        } else {
            torque
        }
    }

    /// Torque on the load side without friction and link, N m.
    #[inline(always)]
    pub(super) fn load_side(
        &self,
        pendulum: &Pendulum,
        touch: &[Touch; BARRIERS],
        position: f64,
        velocity: f64,
    ) -> f64 {
        let m = &self.mechanics;
        let mut torque = m.spring(position);
        if m.gravity != 0.0 {
            torque -= m.gravity * pendulum.sin(m.from_hanging_rad(position));
        }
        for (barrier, touch) in self.parts.barriers.iter().zip(touch) {
            torque += barrier.torque(*touch, position, velocity);
        }
        torque
    }

    /// Torque from the motor side on the load side, N m; 0 without a link.
    #[inline]
    pub(super) fn through(&self, state: &State) -> f64 {
        if !self.parts.has_link {
            return 0.0;
        }
        let twist = state.position - state.load_position;
        let rate = state.velocity - state.load_velocity;
        self.parts.link.torque(twist, rate)
    }

    /// Torque on the motor side without dry friction, N m. `through` is the torque of the link.
    #[inline]
    pub(super) fn pull(&self, state: &State, drive_nm: f64, through: f64) -> f64 {
        let m = &self.mechanics;
        let (position, velocity) = (state.position, state.velocity);
        let motor = self.motor_side(drive_nm, position) - self.friction_share[0] * m.drag(velocity);
        motor
            + if self.parts.has_link {
                -through
            } else {
                self.load_side(&state.pendulum, &state.touch, position, velocity)
            }
    }

    /// Torque on the load side without dry friction, N m. `through` is the torque of the link.
    #[inline]
    pub(super) fn load_pull(&self, state: &State, through: f64) -> f64 {
        let (position, velocity) = (state.load_position, state.load_velocity);
        through + self.load_side(&state.pendulum, &state.touch, position, velocity)
            - self.friction_share[1] * self.mechanics.drag(velocity)
    }
}
