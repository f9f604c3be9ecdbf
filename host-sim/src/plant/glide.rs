//! Most steps: sliding, with nothing stiff in action, by the midpoint rule and without a search for events.

use super::pace::MIDPOINT_ON_SLOPE;
use super::{Barrier, Plant, State, Torque, Touch};

impl Plant {
    /// Carries `state` over `dt_s` if the plant only slides meanwhile. Otherwise returns false and leaves `state` as it
    /// was.
    #[inline]
    pub(super) fn glides(&self, state: &mut State, torque: &Torque, dt_s: f64) -> bool {
        if dt_s > self.longest_glide_s {
            return false;
        }
        let direction = if self.dry {
            state.phase.direction()
        } else {
            state.velocity.signum()
        };
        if self.dry && direction * state.velocity <= 0.0 {
            return false;
        }
        let changes = self.until_change(state, dt_s) < dt_s;
        if changes || state.touch.contains(&Touch::Pushing) {
            return false;
        }
        let m = &self.mechanics;
        let [drive_nm, early_nm] = torque.means(dt_s);
        // Where friction falls with speed, the error of the midpoint rule is too large.
        if dt_s > self.longest_on_slope(state, drive_nm, MIDPOINT_ON_SLOPE) {
            return false;
        }
        state.pendulum.follow(m.from_hanging_rad(state.position));
        let constant_friction_nm = self.constant_friction_nm(0, direction);
        let acceleration = |position: f64, velocity: f64, t_s: f64| {
            let motor = self.motor_side(drive_nm, position);
            let load = self.load_side(&state.pendulum, &state.touch, position, velocity);
            let friction = constant_friction_nm.unwrap_or_else(|| {
                let (speed, time_s) = (velocity.abs(), state.time_s + t_s);
                direction * m.sliding(direction, position, speed, time_s, drive_nm)
            });
            (motor + load - m.drag(velocity) - friction) * self.inverse_inertia[0]
        };
        let half_s = 0.5 * dt_s;
        let first = acceleration(state.position, state.velocity, 0.0);
        let midway = state.velocity + half_s * first;
        // A torque early in the step moves the joint farther than one late in the step.
        let ahead = half_s * (early_nm - drive_nm) * self.inverse_inertia[0];
        let position = state.position + dt_s * (midway + ahead);
        let halfway = acceleration(state.position + half_s * state.velocity, midway, half_s);
        let velocity = state.velocity + dt_s * halfway;
        let turns = direction * midway <= 0.0 || direction * velocity <= 0.0;
        if turns || self.meets_barrier(state, position, velocity) {
            return false;
        }
        state.position = position;
        state.velocity = velocity;
        true
    }

    /// True if a contact with a barrier has begun or ended since a state, or if the motion has reversed: the joint was
    /// then farther in between and may have touched a barrier.
    #[inline]
    pub(super) fn meets_barrier(&self, state: &State, position: f64, velocity: f64) -> bool {
        let before = if self.parts.has_link {
            state.load_velocity
        } else {
            state.velocity
        };
        let has_turned = before * velocity < 0.0;
        let meets = |(barrier, touch): (&Barrier, &Touch)| {
            let is_left = has_turned || barrier.guard(*touch, position, velocity) < 0.0;
            barrier.is_there(state.time_s) && is_left
        };
        self.parts.barriers.iter().zip(&state.touch).any(meets)
    }
}
