//! Two masses and their link, the motor side on bristles.

use super::super::linear_load::LinearLoad;
use super::super::presliding::Bending;
use super::super::two_mass::flow_index;
use super::super::{Phase, Touch};
use super::bristles::{STIFF_RATE_STEP, parts_of};
use super::integration::Integration;
use super::nonlinear::Nonlinear;
use super::{Follower, LATE_RATE_STEP, is_answered, is_usual, late_s};

/// Bristles never hold the motor side, and nothing holds the load side.
const NONE_HELD: [bool; 2] = [false; 2];

impl Follower<'_> {
    /// Integrates steps on one flank. In each part of a step the bristles have their torque in the middle of the part.
    pub(super) fn bend_linked(&mut self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        let m = &plant.mechanics;
        let until_s = self.until_s(integration.state);
        let state = &*integration.state;
        if state.touch.contains(&Touch::Pushing) {
            return;
        }
        let bristles = &plant.parts.bristles;
        let link = &plant.parts.link;
        let inverse = plant.inverse_inertia[0];
        let step_s = self.step_s;
        let parts = parts_of(self.bristle_rate() * step_s);
        let part_s = step_s / parts;
        if self.bristle_rate() * part_s > STIFF_RATE_STEP {
            return;
        }
        let mut x = [
            state.position,
            state.velocity,
            state.load_position,
            state.load_velocity,
        ];
        let flank = link.flank(x[0] - x[2], x[1] - x[3]);
        let linear_load = LinearLoad::of(plant, state);
        let flow =
            &*self.on_bristles.two_masses[flow_index(flank, NONE_HELD)].get_or_insert_with(|| {
                Box::new(plant.two_masses_held(flank, NONE_HELD, &linear_load, part_s))
            });
        let (stiffness, _, relaxed) = link.spring(flank);
        let constant_nm = [
            m.offset_nm + stiffness * relaxed,
            linear_load.constant_nm - stiffness * relaxed,
        ];
        let bent = [0, 1].map(|side| Nonlinear::of(plant, side, 0.0));
        let linked_rate = plant.spring_rate + link.fastest_rate(m.inertia);
        let mut pendulum = state.pendulum;
        let mut bending = Bending::from(bristles, state.deflection);
        let mut due = 0.0;
        // For the way to the middle the torque of the part before is close enough.
        let mut before_nm = [0.0; 2];
        while let Some(push) = integration.push() {
            let state = &mut *integration.state;
            let goes_on = state.phase == Phase::Bristle && is_usual(&push, step_s);
            let late_s = late_s(&push, step_s);
            let is_late = linked_rate * late_s.abs() > LATE_RATE_STEP;
            let goes_on = goes_on && !is_late && !is_answered(&push, plant.spring_rate);
            if !goes_on || state.time_s + push.lasts_s > until_s {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let forces = |bent_nm: [f64; 2]| {
                [
                    constant_nm[0] + mean_nm + bent_nm[0],
                    constant_nm[1] + bent_nm[1],
                ]
            };
            let (mut end, mut bent_nm) = (x, before_nm);
            let (mut on, mut way_due) = (bending, due);
            for part in 0..parts as usize {
                let halfway_s = state.time_s + (part as f64 + 0.5) * part_s;
                let midway = flow.half.of(&end, &forces(bent_nm));
                on.go(way_due + midway[0] - end[0]);
                let z = on.deflection();
                let [position, velocity, load_position, load_velocity] = midway;
                let speed = velocity.abs();
                let level = m.sliding(1f64.copysign(z), position, speed, halfway_s, mean_nm);
                let damping = bristles.damping * on.bends(velocity);
                let damped_nm = damping * velocity / (1.0 + 0.5 * part_s * damping * inverse);
                bent_nm = [
                    bent[0].motor(position, velocity, halfway_s, mean_nm)
                        - level * z / bristles.distance
                        - damped_nm,
                    bent[1].load(&mut pendulum, load_position)
                        - bent[1].resists(load_position, load_velocity, halfway_s, mean_nm),
                ];
                end = flow.whole.of(&end, &forces(bent_nm));
                way_due = end[0] - position;
            }
            let on_time = end[0];
            end = flow.soon(&end, &forces(bent_nm), late_s);
            // A torque early in the step moves the motor side farther than one late in the step.
            end[0] += 0.5 * step_s * step_s * (early_nm - mean_nm) * inverse;
            way_due += end[0] - on_time;
            let leaves = link.guard(flank, end[0] - end[2], end[1] - end[3]) < 0.0;
            if leaves || plant.meets_barrier(state, end[2], end[3]) {
                break;
            }
            (x, before_nm, bending, due) = (end, bent_nm, on, way_due);
            [
                state.position,
                state.velocity,
                state.load_position,
                state.load_velocity,
            ] = end;
            if bristles.may_slide(end[1], push.lasts_s) {
                bending.go(due);
                due = 0.0;
                state.deflection = bending.deflection();
                plant.slides_on(state, push.lasts_s);
            }
            integration.step(&push, if link.sensor_on_load { end[2] } else { end[0] });
        }
        bending.go(due);
        integration.state.deflection = bending.deflection();
        integration.state.pendulum = pendulum;
    }
}
