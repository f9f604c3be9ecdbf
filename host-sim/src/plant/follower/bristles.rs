//! One mass on bristles.

use super::super::presliding::Bending;
use super::super::{Phase, Touch};
use super::integration::Integration;
use super::{Follower, is_answered};

/// Angle of an oscillation on bristles in one part of a step, rad; most parts of a step; and largest product of a part
/// and the rate on springs and dampers.
const BRISTLE_ANGLE: f64 = 0.2;
const MOST_PARTS: f64 = 6.0;
pub(super) const STIFF_RATE_STEP: f64 = 1.0;

/// Number of parts of a step for the angle of an oscillation within it.
#[inline]
pub(super) fn parts_of(angle: f64) -> f64 {
    (angle / BRISTLE_ANGLE).ceil().clamp(1.0, MOST_PARTS)
}

impl Follower<'_> {
    /// Angular frequency of an oscillation on bristles of this sliding level, 1/s.
    pub(super) fn bristle_rate(&self) -> f64 {
        let friction = &self.plant.mechanics.friction;
        let holding = friction.highest_nm() * friction.stribeck.ratio;
        let inertia = self.plant.inverse_inertia[0].recip();
        self.plant.parts.bristles.natural_rate(inertia, holding) + self.bent_rate
    }

    /// Bristles depend on the way and not on time. A step goes half of its way, is pushed there, and goes the rest. The
    /// bristles bend by that rest together with the first half of the next step.
    pub(super) fn bend(&self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        let m = &plant.mechanics;
        let bristles = &plant.parts.bristles;
        let inertia = m.inertia;
        let until_s = self.until_s(integration.state);
        if integration.state.touch.contains(&Touch::Pushing) {
            return;
        }
        let rate = self.bristle_rate();
        let spring_rate = rate + plant.spring_rate;
        let mut bending = Bending::from(bristles, integration.state.deflection);
        let mut due = 0.0;
        while let Some(push) = integration.push() {
            let state = &mut *integration.state;
            if state.phase != Phase::Bristle || state.time_s + push.lasts_s > until_s {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let parts = parts_of(rate * push.lasts_s);
            let part_s = push.lasts_s / parts;
            if spring_rate * part_s > STIFF_RATE_STEP || is_answered(&push, plant.spring_rate) {
                break;
            }
            let half_s = 0.5 * part_s;
            let (mut x, mut v) = (state.position, state.velocity);
            let (mut bent, mut way_due) = (bending, due);
            for part in 0..parts as usize {
                let way = half_s * v;
                x += way;
                bent.go(way_due + way);
                let z = bent.deflection();
                state.pendulum.follow(m.from_hanging_rad(x));
                let level = if plant.plain {
                    m.friction.level(z)
                } else {
                    let halfway_s = state.time_s + (part as f64 + 0.5) * part_s;
                    m.sliding(1f64.copysign(z), x, v.abs(), halfway_s, mean_nm)
                };
                let torque = plant.motor_side(mean_nm, x)
                    + plant.load_side(&state.pendulum, &state.touch, x, v)
                    - level * z / bristles.distance;
                let damping = m.viscous + m.drag * v.abs() + bristles.damping * bent.bends(v);
                let slowed = half_s * damping / inertia;
                v = ((1.0 - slowed) * v + part_s * torque / inertia) / (1.0 + slowed);
                way_due = half_s * v;
                x += way_due;
            }
            // A torque early in the step moves the mass farther than one late in the step.
            x += 0.5 * push.lasts_s * push.lasts_s * (early_nm - mean_nm) / inertia;
            if plant.meets_barrier(state, x, v) {
                break;
            }
            [state.position, state.velocity] = [x, v];
            (bending, due) = (bent, way_due);
            if bristles.may_slide(v, push.lasts_s) {
                bending.go(due);
                due = 0.0;
                state.deflection = bending.deflection();
                plant.slides_on(state, push.lasts_s);
            }
            integration.step(&push, x);
        }
        bending.go(due);
        integration.state.deflection = bending.deflection();
    }
}
