//! Two masses and their link.

use super::super::linear_load::LinearLoad;
use super::super::link::Flank;
use super::super::two_mass::flow_index;
use super::super::zero_order_hold::ZeroOrderHold;
use super::super::{Phase, Plant, Push, State};
use super::friction_level::FrictionLevel;
use super::integration::Integration;
use super::nonlinear::Nonlinear;
use super::side::Side;
use super::{Follower, LATE_RATE_STEP, is_answered, is_usual, late_s};

impl Follower<'_> {
    /// Integrates steps as long as the link stays on one flank; friction may hold either mass.
    pub(super) fn coast_linked(&mut self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        let m = &plant.mechanics;
        let state = &*integration.state;
        let sides = [
            Side::of(plant.dry, state.velocity, state.phase),
            Side::of(plant.load_is_dry(), state.load_velocity, state.load_phase),
        ];
        let have = |x: &[f64; 4]| sides[0].has(x[1]) && sides[1].has(x[3]);
        let mut x = [
            state.position,
            state.velocity,
            state.load_position,
            state.load_velocity,
        ];
        if !have(&x) {
            return;
        }
        let until_s = self.until_s(integration.state);
        let Some(linear_load) = self.linear_load(integration.state) else {
            return;
        };
        let step_s = self.step_s;
        if plant.may_turn_twice(&linear_load, step_s) {
            return;
        }
        let link = &plant.parts.link;
        let flank = link.flank(x[0] - x[2], x[1] - x[3]);
        let held = sides.map(|side| side == Side::Held);
        let is_linear = self.is_linear;
        let flow = &*self.flows(&linear_load).two_masses[flow_index(flank, held)]
            .get_or_insert_with(|| {
                Box::new(plant.two_masses_held(flank, held, &linear_load, step_s))
            });
        let (stiffness, damping, relaxed) = link.spring(flank);
        let directions = sides.map(Side::direction);
        let constant_nm = [
            m.offset_nm + stiffness * relaxed,
            linear_load.constant_nm - stiffness * relaxed,
        ];
        let level = |side: usize| {
            FrictionLevel::of(plant, side, directions[side], integration.state.time_s)
        };
        let [mut motor_level, mut load_level] = [level(0), level(1)];
        let bent = [0, 1].map(|side| Nonlinear::of(plant, side, directions[side]));
        let varies = bent.iter().any(|bent| bent.varies);
        let mut pendulum = integration.state.pendulum;
        let mut bent_nm = |x: &[f64; 4], time_s: f64, drive_nm: f64| {
            if is_linear {
                return [0.0; 2];
            }
            [
                bent[0].motor(x[0], x[1], time_s, drive_nm),
                bent[1].load(&mut pendulum, x[2]) - bent[1].resists(x[2], x[3], time_s, drive_nm),
            ]
        };
        // True if the masses that friction holds stay at rest under this nonlinear torque.
        let sticks = |state: &State, x: &[f64; 4], push: &Push, bent_nm: [f64; 2]| {
            let through_nm = stiffness * (x[0] - x[2]) + damping * (x[1] - x[3]);
            let motor_sticks = |drive_nm: f64| {
                let pull = drive_nm + constant_nm[0] + bent_nm[0] - through_nm;
                pull.abs() <= plant.holding(state, pull, drive_nm)
            };
            let load_sticks = || {
                let pull = constant_nm[1] + bent_nm[1] + through_nm - linear_load.stiffness * x[2];
                pull.abs() <= plant.load_holding(state, pull, push.means_nm[0])
            };
            (!held[0] || push.bounds_nm.into_iter().all(motor_sticks))
                && (!held[1] || load_sticks())
        };
        let is_held = held[0] || held[1];
        let rate = plant.spring_rate + linear_load.rate(plant.inverse_inertia[1]);
        let linked_rate = rate + link.fastest_rate(m.inertia);
        // For the first half of this step the nonlinear torque of the step before is close enough.
        let mut before_nm = None;
        let from = integration.next();
        while let Some(push) = integration.push() {
            let state = &mut *integration.state;
            if !is_usual(&push, step_s) || state.time_s + push.lasts_s > until_s {
                break;
            }
            if varies && plant.is_steep(state, &push) {
                break;
            }
            if is_answered(&push, rate) || plant.drags(state, &push) {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let mut late_s = late_s(&push, step_s);
            let own;
            let (flow, step_s) = if linked_rate * late_s.abs() > LATE_RATE_STEP {
                own = plant.two_masses_held(flank, held, &linear_load, push.lasts_s);
                late_s = 0.0;
                (&own, push.lasts_s)
            } else {
                (&**flow, step_s)
            };
            let first_nm = match before_nm.filter(|_| !is_held) {
                Some(before_nm) => before_nm,
                None => bent_nm(&x, state.time_s, mean_nm),
            };
            if is_held && !sticks(state, &x, &push, first_nm) {
                break;
            }
            let halfway_s = state.time_s + 0.5 * step_s;
            let [motor_nm, load_nm] = [motor_level.at(halfway_s), load_level.at(halfway_s)];
            let forces = |bent_nm: [f64; 2]| {
                [
                    constant_nm[0] + mean_nm + bent_nm[0] - motor_nm,
                    constant_nm[1] + bent_nm[1] - load_nm,
                ]
            };
            let midway = || flow.half.of(&x, &forces(first_nm));
            let mut acting_nm = first_nm;
            if !is_linear {
                let midway = midway();
                if !have(&midway) {
                    break;
                }
                acting_nm = bent_nm(&midway, halfway_s, mean_nm);
            }
            let acting = forces(acting_nm);
            let mut end = flow.whole.of(&x, &acting);
            end = flow.soon(&end, &acting, late_s);
            if is_linear {
                let stopped =
                    |side: usize| sides[side].may_have_stopped(x[2 * side + 1], end[2 * side + 1]);
                if (stopped(0) || stopped(1)) && !have(&midway()) {
                    break;
                }
            }
            if !held[0] {
                // A torque early in the step moves the motor side farther than one late in the step.
                let ahead = (early_nm - mean_nm) * plant.inverse_inertia[0];
                end[0] += 0.5 * step_s * step_s * ahead;
            }
            let leaves = link.guard(flank, end[0] - end[2], end[1] - end[3]) < 0.0;
            if leaves
                || !have(&end)
                || plant.meets_barrier(state, end[2], end[3])
                || is_held && !sticks(state, &end, &push, bent_nm(&end, state.time_s, mean_nm))
            {
                break;
            }
            before_nm = Some(acting_nm);
            x = end;
            [
                state.position,
                state.velocity,
                state.load_position,
                state.load_velocity,
            ] = end;
            integration.step(&push, if link.sensor_on_load { end[2] } else { end[0] });
        }
        let has_gone = integration.next() > from;
        let state = &mut *integration.state;
        state.pendulum = pendulum;
        if has_gone {
            for (phase, held) in [&mut state.phase, &mut state.load_phase]
                .into_iter()
                .zip(held)
            {
                if held {
                    *phase = Phase::Stick;
                }
            }
        }
    }
}

impl Plant {
    /// The linear solution of two masses on one flank of their link; friction may hold the motor side, the load side, or both.
    pub(super) fn two_masses_held(
        &self,
        flank: Flank,
        held: [bool; 2],
        linear_load: &LinearLoad,
        step_s: f64,
    ) -> ZeroOrderHold<4, 2> {
        let viscous = self
            .friction_share
            .map(|share| share * self.mechanics.viscous);
        let rates = self.two_mass_rates(flank, held, linear_load, viscous);
        let [motor, load] = self.mobility(held);
        let inputs = [[0.0, motor, 0.0, 0.0], [0.0, 0.0, 0.0, load]];
        ZeroOrderHold::new(rates, inputs, step_s)
    }

    /// Inverse inertia of motor side and load side, 0 for one that is held, 1/(kg m²).
    fn mobility(&self, held: [bool; 2]) -> [f64; 2] {
        let mobility = |side: usize| {
            if held[side] {
                0.0
            } else {
                self.inverse_inertia[side]
            }
        };
        [mobility(0), mobility(1)]
    }

    /// Rates of that flow, with this damping of motor side and load side in their bearings, N m s/rad.
    pub(in super::super) fn two_mass_rates(
        &self,
        flank: Flank,
        held: [bool; 2],
        linear_load: &LinearLoad,
        viscous: [f64; 2],
    ) -> [[f64; 4]; 4] {
        let [motor, load] = self.mobility(held);
        let (stiffness, damping, _) = self.parts.link.spring(flank);
        [
            [0.0, -motor * stiffness, 0.0, load * stiffness],
            [1.0, -motor * (damping + viscous[0]), 0.0, load * damping],
            [
                0.0,
                motor * stiffness,
                0.0,
                -load * (stiffness + linear_load.stiffness),
            ],
            [
                0.0,
                motor * damping,
                1.0,
                -load * (damping + viscous[1] + linear_load.damping),
            ],
        ]
    }
}
