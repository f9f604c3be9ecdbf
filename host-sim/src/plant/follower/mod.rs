//! Integrates a plant over a torque profile, mostly in steps of one size. While dry friction keeps its direction and no contact
//! changes, the linear part is integrated exactly, and the nonlinear part is taken at the middle of the step (the exponential
//! midpoint rule: Hochbruck and Ostermann, Acta Numerica 19, 2010).

mod bristles;
mod friction_level;
mod integration;
mod linked;
mod linked_bristles;
mod nonlinear;
mod side;
mod sliding;

use super::drift::Drifting;
use super::linear_load::LinearLoad;
use super::pace::MIDPOINT_ON_SLOPE;
use super::stiff::TURN;
use super::two_mass::FLOWS;
use super::zero_order_hold::ZeroOrderHold;
use super::{Phase, Plant, Push, Rest, State, TorqueProfile};
use integration::Integration;

/// A plant, with its linear solutions over the usual step.
#[derive(Debug)]
pub struct Follower<'a> {
    plant: &'a Plant,
    step_s: f64,
    is_linear: bool,
    /// Fastest rate of the nonlinear part, 1/s.
    bent_rate: f64,
    /// True if the usual step is short enough for that rate.
    is_gentle: bool,
    free: Flows,
    /// While a barrier pushes, with its linear load.
    pushed: Option<(LinearLoad, Flows)>,
    /// Solutions over parts of a step, where one of two masses is on bristles.
    on_bristles: Flows,
}

/// Solutions under one linear load, each computed when it is first needed.
#[derive(Debug, Default)]
struct Flows {
    one_mass: Option<ZeroOrderHold<2, 1>>,
    /// By flank and by the sides that friction holds.
    two_masses: [Option<Box<ZeroOrderHold<4, 2>>>; FLOWS],
}

/// Largest product of the fastest rate of the nonlinear part and the step. The relative error of the midpoint rule's
/// frequency is the square of this, over 24. With two masses the nonlinear part acts beside the link, which is stepped
/// exactly, or within its play.
const MIDPOINT_RATE_STEP: f64 = 0.1;
const LINKED_RATE_STEP: f64 = 0.5;
/// Largest product of the rate on a barrier and the step. A joint that leaves the barrier does not come back within one
/// step.
const PUSHED_RATE_STEP: f64 = 1.0;
/// Relative difference up to which a step counts as the usual one, and from which on the difference matters.
const NEAR_USUAL: f64 = 0.3;
const SAME: f64 = 1e-9;
/// Largest product of the fastest linear rate and the difference from the usual step that a parabola follows. Its error
/// is a sixth of the cube. Beyond, the step gets a solution of its own.
const LATE_RATE_STEP: f64 = 0.1;
/// Product of the fastest linear rate and the step up to which a torque that changes within the step moves a mass as if it were free.
const EARLY_RATE_STEP: f64 = 0.05;

impl<'a> Follower<'a> {
    /// A follower of a plant whose usual step takes `step_s`.
    pub fn new(plant: &'a Plant, step_s: f64) -> Self {
        let m = &plant.mechanics;
        let rate = |mobility: f64| (m.bent_stiffness() * mobility).sqrt();
        let bent_rate = rate(m.inertia.recip());
        let linked_rate = rate(plant.highest_mobility());
        Self {
            plant,
            step_s,
            is_linear: m.gravity == 0.0
                && m.hardening == 0.0
                && m.cogging.is_none()
                && m.drag == 0.0
                && (plant.is_level || !plant.dry),
            bent_rate,
            is_gentle: bent_rate * step_s <= MIDPOINT_RATE_STEP
                && linked_rate * step_s <= LINKED_RATE_STEP,
            free: Flows::default(),
            pushed: None,
            on_bristles: Flows::default(),
        }
    }

    /// Carries `state` through the steps of a torque profile, multiplied by a `gain` that is not negative. `seen` gets
    /// the sensor's position after each step, rad.
    pub fn follow(
        &mut self,
        state: &mut State,
        profile: &TorqueProfile,
        gain: f64,
        seen: &mut [f64],
    ) {
        let mut integration = Integration::new(self.plant, state, profile, gain, seen);
        while !integration.is_over() {
            let from = integration.next();
            self.coast(&mut integration);
            if integration.next() == from {
                integration.by_pieces(self.plant);
            }
        }
    }

    /// Integrates steps as long as one linear solution is valid.
    #[inline]
    fn coast(&mut self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        let bends = integration.state.phase == Phase::Bristle;
        if plant.parts.has_link {
            if !self.is_gentle {
                return;
            }
            if bends {
                self.bend_linked(integration);
            } else {
                self.coast_linked(integration);
            }
            return;
        }
        let from = integration.next();
        self.rest(integration);
        if integration.next() > from {
            return;
        }
        if bends {
            self.bend(integration);
        } else if self.is_gentle {
            self.slide(integration);
        }
    }

    /// Integrates steps as long as the plant stays at rest.
    #[inline]
    fn rest(&self, integration: &mut Integration<'_>) {
        let plant = self.plant;
        if !plant.rests(integration.state) {
            return;
        }
        let until_s = self.rests_until_s(integration.state);
        let friction = &plant.mechanics.friction;
        let drift = friction.drift.filter(|_| plant.is_level);
        let mut drifting = drift.map(|drift| Drifting::from(drift, integration.state.time_s));
        while let Some(push) = integration.push() {
            let end_s = integration.state.time_s + push.lasts_s;
            let stays = end_s <= until_s
                && match &mut drifting {
                    Some(drifting) => {
                        let factor = drifting.factor(end_s);
                        let holding = |pull: f64, _| factor * friction.level(pull);
                        plant.is_held_by(integration.state, push.bounds_nm, holding)
                    }
                    None => plant.stays_at_rest(integration.state, push.bounds_nm, push.lasts_s),
                };
            if !stays {
                break;
            }
            integration.step(&push, integration.state.position);
        }
    }

    /// Time up to which the torque on the resting plant does not change by itself, s.
    #[inline]
    fn rests_until_s(&self, state: &mut State) -> f64 {
        if !self.plant.is_timed {
            return f64::INFINITY;
        }
        state.rest = Rest::UNKNOWN;
        self.until_s(state)
    }

    /// Time at which the linear solution ends in any case, s.
    #[inline]
    fn until_s(&self, state: &mut State) -> f64 {
        state.time_s + self.plant.until_change(state, f64::INFINITY)
    }

    /// The linear load of the load side, if the usual step is short enough for it.
    #[inline]
    fn linear_load(&self, state: &State) -> Option<LinearLoad> {
        let linear_load = LinearLoad::of(self.plant, state);
        let is_soft =
            || linear_load.rate(self.plant.inverse_inertia[1]) * self.step_s <= PUSHED_RATE_STEP;
        (!linear_load.pushes || is_soft()).then_some(linear_load)
    }

    /// The solutions under a linear load.
    #[inline]
    fn flows(&mut self, linear_load: &LinearLoad) -> &mut Flows {
        if !linear_load.pushes {
            return &mut self.free;
        }
        if self
            .pushed
            .as_ref()
            .is_none_or(|(known, _)| known != linear_load)
        {
            self.pushed = None;
        }
        let (_, flows) = self
            .pushed
            .get_or_insert_with(|| (*linear_load, Flows::default()));
        flows
    }
}

/// True if the torque changes within a step that is long enough for springs and dampers to respond to that.
#[inline]
fn is_answered(push: &Push, rate: f64) -> bool {
    let [low, high] = push.bounds_nm;
    rate * push.lasts_s > EARLY_RATE_STEP && low != high
}

/// True if a step takes about as long as the usual one.
#[inline]
fn is_usual(push: &Push, step_s: f64) -> bool {
    (push.lasts_s - step_s).abs() <= NEAR_USUAL * step_s
}

/// Duration of a step minus that of the usual one, s.
#[inline]
fn late_s(push: &Push, step_s: f64) -> f64 {
    let late_s = push.lasts_s - step_s;
    if late_s.abs() <= SAME * step_s {
        0.0
    } else {
        late_s
    }
}

impl Plant {
    /// True if a mass may reverse twice within a step, and dry friction or a contact depends on that.
    #[inline]
    fn may_turn_twice(&self, linear_load: &LinearLoad, step_s: f64) -> bool {
        let watches = self.dry || !self.parts.barriers.is_empty();
        let damping = self.mechanics.viscous + linear_load.damping;
        watches && self.turning_rate(linear_load.stiffness.max(0.0), damping) * step_s > TURN
    }

    /// True if friction falls too steeply with speed for this step.
    #[inline]
    fn is_steep(&self, state: &State, push: &Push) -> bool {
        push.lasts_s > self.longest_on_slope(state, push.means_nm[0], MIDPOINT_ON_SLOPE)
    }

    /// True if quadratic drag slows the plant too much within a step.
    #[inline]
    fn drags(&self, state: &State, push: &Push) -> bool {
        self.mechanics.drag != 0.0
            && self.drag_rate(state, push.means_nm[0]) * push.lasts_s > MIDPOINT_RATE_STEP
    }

    /// Inverse inertia of the lighter side, 1/(kg m²).
    pub(super) fn highest_mobility(&self) -> f64 {
        let [motor, load] = self.inverse_inertia;
        motor.max(load)
    }
}
