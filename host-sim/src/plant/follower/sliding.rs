//! One mass that slides.

use super::super::Plant;
use super::super::linear_load::LinearLoad;
use super::super::zero_order_hold::ZeroOrderHold;
use super::friction_level::FrictionLevel;
use super::integration::Integration;
use super::nonlinear::Nonlinear;
use super::side::Side;
use super::{Follower, LATE_RATE_STEP, is_answered, is_usual, late_s};

impl Follower<'_> {
    /// Integrates steps as long as it slides in one direction.
    pub(super) fn slide(&mut self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        let state = &*integration.state;
        let side = Side::of(plant.dry, state.velocity, state.phase);
        if side == Side::Held || !side.has(state.velocity) {
            return;
        }
        let until_s = self.until_s(integration.state);
        let state = &*integration.state;
        let Some(linear_load) = self.linear_load(state) else {
            return;
        };
        let direction = side.direction();
        let step_s = self.step_s;
        if plant.may_turn_twice(&linear_load, step_s) {
            return;
        }
        let rate = plant.spring_rate + linear_load.rate(plant.inverse_inertia[0]);
        let inverse = plant.inverse_inertia[0];
        let is_linear = self.is_linear;
        let flow = &*self
            .flows(&linear_load)
            .one_mass
            .get_or_insert_with(|| plant.one_mass_held(&linear_load, step_s));
        let constant_nm = plant.mechanics.offset_nm + linear_load.constant_nm;
        let mut level = FrictionLevel::of(plant, 0, direction, state.time_s);
        let bent = Nonlinear::of(plant, 0, direction);
        let mut x = [state.position, state.velocity];
        // For the first half of this step the nonlinear torque of the step before is close enough.
        let mut bent_nm = None;
        while let Some(push) = integration.push() {
            let state = &mut *integration.state;
            if !is_usual(&push, step_s) || state.time_s + push.lasts_s > until_s {
                break;
            }
            if bent.varies && plant.is_steep(state, &push) {
                break;
            }
            if is_answered(&push, rate) || plant.drags(state, &push) {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let mut late_s = late_s(&push, step_s);
            let own;
            let (flow, step_s) = if rate * late_s.abs() > LATE_RATE_STEP {
                own = plant.one_mass_held(&linear_load, push.lasts_s);
                late_s = 0.0;
                (&own, push.lasts_s)
            } else {
                (flow, step_s)
            };
            let halfway_s = state.time_s + 0.5 * step_s;
            let mut force = constant_nm + mean_nm - level.at(halfway_s);
            if !is_linear {
                let mut bent = |x: &[f64; 2], time_s: f64| {
                    bent.motor(x[0], x[1], time_s, mean_nm) + bent.load(&mut state.pendulum, x[0])
                };
                let before_nm = bent_nm.unwrap_or_else(|| bent(&x, state.time_s));
                let midway = flow.half.of(&x, &[force + before_nm]);
                if !side.has(midway[1]) {
                    break;
                }
                let acting_nm = bent(&midway, halfway_s);
                bent_nm = Some(acting_nm);
                force += acting_nm;
            }
            let forces = [force];
            let mut end = flow.whole.of(&x, &forces);
            end = flow.soon(&end, &forces, late_s);
            // A torque early in the step moves the joint farther than one late in the step.
            end[0] += 0.5 * step_s * step_s * (early_nm - mean_nm) * inverse;
            if !side.has(end[1]) || plant.meets_barrier(state, end[0], end[1]) {
                break;
            }
            x = end;
            [state.position, state.velocity] = end;
            integration.step(&push, end[0]);
        }
    }
}

impl Plant {
    /// The linear solution of one mass.
    fn one_mass_held(&self, linear_load: &LinearLoad, step_s: f64) -> ZeroOrderHold<2, 1> {
        let rates = self.one_mass_rates(linear_load, self.mechanics.viscous);
        ZeroOrderHold::new(rates, [[0.0, self.inverse_inertia[0]]], step_s)
    }

    /// Rates of the linear equations of one mass, with this damping in addition to that of the linear load, N m s/rad.
    pub(in super::super) fn one_mass_rates(
        &self,
        linear_load: &LinearLoad,
        damping: f64,
    ) -> [[f64; 2]; 2] {
        let inverse = self.inverse_inertia[0];
        let damping = damping + linear_load.damping;
        [
            [0.0, -linear_load.stiffness * inverse],
            [1.0, -damping * inverse],
        ]
    }
}
