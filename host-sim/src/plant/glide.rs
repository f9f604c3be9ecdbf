//! Sliding with nothing stiff in action, which most steps are: the midpoint rule, without a look for what may happen
//! within.

use super::{Barrier, Plant, State, Torque, Touch};

impl Plant {
    /// Carries `state` over `dt_s` if nothing but gentle sliding happens meanwhile; false, and as it was, if anything
    /// does.
    #[inline]
    pub(super) fn glides(&self, state: &mut State, torque: &Torque, dt_s: f64) -> bool {
        if dt_s > self.longest_glide_s || !torque.is_held() {
            return false;
        }
        let direction = if self.dry {
            state.phase.direction()
        } else {
            state.velocity.signum()
        };
        if self.dry && direction * state.velocity <= 0.0 || state.touch.contains(&Touch::Pushing) {
            return false;
        }
        let m = &self.mechanics;
        state.pendulum.follow(state.position - m.gravity_zero);
        let friction = direction * m.friction.level_nm[usize::from(direction < 0.0)];
        let acceleration = |position: f64, velocity: f64| {
            let motor = self.motor_side(torque.target_nm, position);
            let load = self.load_side(&state.pendulum, &state.touch, position, velocity);
            (motor + load - m.drag(velocity) - friction) * self.inverse_inertia[0]
        };
        let first = acceleration(state.position, state.velocity);
        let midway = state.velocity + 0.5 * dt_s * first;
        let position = state.position + dt_s * midway;
        let halfway = acceleration(state.position + 0.5 * dt_s * state.velocity, midway);
        let velocity = state.velocity + dt_s * halfway;
        let turns = direction * midway <= 0.0 || direction * velocity <= 0.0;
        let meets =
            |(barrier, touch): (&Barrier, &Touch)| barrier.guard(*touch, position, velocity) < 0.0;
        if turns || self.parts.barriers.iter().zip(&state.touch).any(meets) {
            return false;
        }
        state.position = position;
        state.velocity = velocity;
        true
    }
}
