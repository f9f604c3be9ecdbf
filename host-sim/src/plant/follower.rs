//! A plant that follows a course of torque, mostly in steps of one size: while dry friction keeps its direction and nothing
//! strikes, all that is linear is stepped exactly, and the rest acts as it does halfway (the exponential midpoint rule:
//! Hochbruck and Ostermann, Acta Numerica 19, 2010).

use super::pendulum::Pendulum;
use super::two_mass::{FLOWS, flow_index};
use super::zero_order_hold::ZeroOrderHold;
use super::{Barrier, Course, Phase, Plant, Push, State, Torque, Touch};

/// A plant, with its linear flows over the step that recurs.
#[derive(Debug)]
pub struct Follower<'a> {
    plant: &'a Plant,
    step_s: f64,
    is_linear: bool,
    /// Fastest rate of what is not linear, 1/s.
    bent_rate: f64,
    /// True if steps are short enough for that.
    is_gentle: bool,
    one_mass: Option<ZeroOrderHold<2, 1>>,
    /// By flank and by what is held, each as it is first met.
    two_masses: [Option<Box<ZeroOrderHold<4, 2>>>; FLOWS],
}

/// Product of the fastest rate of what is not linear and the step: the midpoint's frequency is off by a 24th of the square.
const MIDPOINT_RATE_STEP: f64 = 0.1;
/// Angle of an oscillation on bristles that a step takes at most, and parts of a step at most.
const BRISTLE_ANGLE: f64 = 0.2;
const MOST_PARTS: f64 = 6.0;
/// Share by which a step may differ from the one that recurs, and from which on that makes a difference.
const NEAR_USUAL: f64 = 0.3;
const SAME: f64 = 1e-9;

/// How one side of a plant moves while a flow lasts.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    /// Without dry friction.
    Free,
    /// Held by it.
    Held,
    /// Against it, in a direction of ±1; 0 on bristles.
    Sliding(f64),
}

impl Side {
    #[inline]
    fn of(dry: bool, velocity: f64, phase: Phase) -> Self {
        if !dry {
            Self::Free
        } else if velocity == 0.0 {
            Self::Held
        } else {
            Self::Sliding(phase.direction())
        }
    }

    #[inline]
    fn direction(self) -> f64 {
        match self {
            Self::Sliding(direction) => direction,
            Self::Free | Self::Held => 0.0,
        }
    }

    /// True if it can have this velocity.
    #[inline]
    fn has(self, velocity: f64) -> bool {
        match self {
            Self::Free | Self::Held => true,
            Self::Sliding(direction) => direction * velocity > 0.0,
        }
    }

    /// True if it may have stopped between two velocities, a step apart, that it can have.
    #[inline]
    fn may_have_stopped(self, from: f64, to: f64) -> bool {
        self.direction() != 0.0 && to.abs() < (to - from).abs()
    }
}

/// What acts on one side, its linear part and what is the same at all times apart.
struct Bent<'a> {
    plant: &'a Plant,
    side: usize,
    direction: f64,
    varies: bool,
}

impl<'a> Bent<'a> {
    fn of(plant: &'a Plant, side: usize, direction: f64) -> Self {
        Self {
            plant,
            side,
            direction,
            varies: plant.constant_friction_nm(side, direction).is_none(),
        }
    }

    /// Drag beyond the viscous one, and friction that is not the same at all times, N m.
    #[inline]
    fn resists(&self, position: f64, velocity: f64, time_s: f64, drive_nm: f64) -> f64 {
        let m = &self.plant.mechanics;
        let share = self.plant.friction_share[self.side];
        let mut torque = m.drag * velocity.abs() * velocity;
        if self.varies {
            let speed = velocity.abs();
            let level = m
                .friction
                .sliding(self.direction, position, speed, time_s, drive_nm);
            torque += self.direction * level;
        }
        share * torque
    }

    /// N m.
    #[inline]
    fn motor(&self, position: f64, velocity: f64, time_s: f64, drive_nm: f64) -> f64 {
        let mut torque = -self.resists(position, velocity, time_s, drive_nm);
        if self.plant.parts.has_cogging {
            torque += self.plant.parts.cogging.torque(position);
        }
        torque
    }

    /// N m.
    #[inline]
    fn gravity(&self, pendulum: &mut Pendulum, position: f64) -> f64 {
        let m = &self.plant.mechanics;
        if m.gravity == 0.0 {
            return 0.0;
        }
        let angle = position - m.gravity_zero;
        pendulum.follow(angle);
        -m.gravity * pendulum.sin(angle)
    }
}

impl<'a> Follower<'a> {
    /// Of steps that mostly take `step_s`.
    pub fn new(plant: &'a Plant, step_s: f64) -> Self {
        let m = &plant.mechanics;
        let cogging = m.cogging.map_or(0.0, |cogging| cogging.stiffness());
        let bent_rate = ((m.gravity.abs() + cogging) * plant.highest_mobility()).sqrt();
        Self {
            plant,
            step_s,
            is_linear: m.gravity == 0.0
                && m.cogging.is_none()
                && m.drag == 0.0
                && (plant.plain || !plant.dry),
            bent_rate,
            is_gentle: bent_rate * step_s <= MIDPOINT_RATE_STEP,
            one_mass: None,
            two_masses: Default::default(),
        }
    }

    /// Carries `state` through the steps of a course; where the position sensor is after each of them goes into `seen`.
    pub fn follow(&mut self, state: &mut State, course: &Course, seen: &mut [f64]) {
        let mut step = 0;
        while step < course.steps() {
            let next = self.coast(state, course, step, seen);
            if next > step {
                step = next;
                continue;
            }
            let (push, pieces) = (course.push(step), course.pieces(step));
            if pieces.is_empty() {
                let held = Torque::held(push.means_nm[0]);
                self.plant.advance(state, held, push.lasts_s);
            }
            for &(torque, piece_s) in pieces {
                self.plant.advance(state, torque, piece_s);
            }
            seen[step] = self.plant.seen(state).0;
            step += 1;
        }
    }

    /// Carries it on through steps of one flow, as far as that lasts; the step that is next then.
    #[inline]
    fn coast(
        &mut self,
        state: &mut State,
        course: &Course,
        from: usize,
        seen: &mut [f64],
    ) -> usize {
        let plant = self.plant;
        if plant.parts.has_link {
            if plant.parts.has_bristles || !self.is_gentle {
                return from;
            }
            return self.coast_linked(state, course, from, seen);
        }
        let mut next = from;
        while next < course.steps() && plant.stays_at_rest(state, course.push(next).bounds_nm) {
            state.time_s += course.push(next).lasts_s;
            seen[next] = state.position;
            next += 1;
        }
        if next > from {
            return next;
        }
        if state.phase == Phase::Bristle {
            self.bend(state, course, from, seen)
        } else if self.is_gentle {
            self.slide(state, course, from, seen)
        } else {
            from
        }
    }

    /// One mass on bristles: as they know the way and no time, a step goes half of its way, is pushed there, and goes the rest.
    fn bend(&self, state: &mut State, course: &Course, from: usize, seen: &mut [f64]) -> usize {
        let plant = self.plant;
        let m = &plant.mechanics;
        let bristles = &plant.parts.bristles;
        let inertia = m.inertia;
        let Some(until_s) = self.until_s(state) else {
            return from;
        };
        let holding = m.friction.highest_nm() * m.friction.stribeck.ratio;
        let rate = bristles.natural_rate(inertia, holding) + self.bent_rate;
        let mut next = from;
        while next < course.steps() && state.phase == Phase::Bristle {
            let push = course.push(next);
            if state.time_s + push.lasts_s > until_s {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let parts = (rate * push.lasts_s / BRISTLE_ANGLE)
                .ceil()
                .clamp(1.0, MOST_PARTS);
            let part_s = push.lasts_s / parts;
            let half_s = 0.5 * part_s;
            let (mut x, mut v, mut z) = (state.position, state.velocity, state.deflection);
            for part in 0..parts as usize {
                let way = half_s * v;
                (x, z) = (x + way, bristles.bent(z, way));
                state.pendulum.follow(x - m.gravity_zero);
                let level = m.friction.sliding(
                    1f64.copysign(z),
                    x,
                    v.abs(),
                    state.time_s + (part as f64 + 0.5) * part_s,
                    mean_nm,
                );
                let torque = plant.motor_side(mean_nm, x)
                    + plant.load_side(&state.pendulum, &state.touch, x, v)
                    - level * z / bristles.distance;
                let damping =
                    m.viscous + m.drag * v.abs() + bristles.damping * bristles.bends(v, z);
                let slowed = half_s * damping / inertia;
                v = ((1.0 - slowed) * v + part_s * torque / inertia) / (1.0 + slowed);
                let way = half_s * v;
                (x, z) = (x + way, bristles.bent(z, way));
            }
            // A torque that comes early moves it farther.
            x += 0.5 * push.lasts_s * push.lasts_s * (early_nm - mean_nm) / inertia;
            if plant.meets_barrier(state, x, v) {
                break;
            }
            [state.position, state.velocity, state.deflection] = [x, v, z];
            plant.slides_on(state, push.lasts_s);
            state.time_s += push.lasts_s;
            seen[next] = x;
            next += 1;
        }
        next
    }

    /// Time at which the flow ends whatever happens, s; none if it may not begin.
    #[inline]
    fn until_s(&self, state: &mut State) -> Option<f64> {
        let until_s = state.time_s + self.plant.until_barriers_change(state, f64::INFINITY);
        (!state.touch.contains(&Touch::Pushing)).then_some(until_s)
    }

    /// One mass that slides.
    fn slide(
        &mut self,
        state: &mut State,
        course: &Course,
        from: usize,
        seen: &mut [f64],
    ) -> usize {
        let plant = self.plant;
        let m = &plant.mechanics;
        let side = Side::of(plant.dry, state.velocity, state.phase);
        if side == Side::Held || !side.has(state.velocity) {
            return from;
        }
        let Some(until_s) = self.until_s(state) else {
            return from;
        };
        let direction = side.direction();
        let step_s = self.step_s;
        let inverse = plant.inverse_inertia[0];
        let is_linear = self.is_linear;
        let flow = &*self
            .one_mass
            .get_or_insert_with(|| plant.one_mass_held(step_s));
        let constant_nm = m.offset_nm + m.stiffness * m.stiffness_zero
            - plant.constant_friction_nm(0, direction).unwrap_or(0.0);
        let bent = Bent::of(plant, 0, direction);
        let mut x = [state.position, state.velocity];
        // Near what acted over the step before, which is near enough for the way halfway.
        let mut bent_nm = None;
        let mut next = from;
        while next < course.steps() {
            let push = course.push(next);
            if !is_usual(push, step_s) || state.time_s + push.lasts_s > until_s {
                break;
            }
            if bent.varies && plant.is_steep(state, push) {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let mut force = constant_nm + mean_nm;
            if !is_linear {
                let mut bent = |x: &[f64; 2], time_s: f64| {
                    bent.motor(x[0], x[1], time_s, mean_nm)
                        + bent.gravity(&mut state.pendulum, x[0])
                };
                let before_nm = bent_nm.unwrap_or_else(|| bent(&x, state.time_s));
                let midway = flow.half.of(&x, &[force + before_nm]);
                if !side.has(midway[1]) {
                    break;
                }
                let acting_nm = bent(&midway, state.time_s + 0.5 * step_s);
                bent_nm = Some(acting_nm);
                force += acting_nm;
            }
            let mut end = after(flow, push, &x, &[force]);
            // A torque that comes early moves it farther.
            end[0] += 0.5 * step_s * step_s * (early_nm - mean_nm) * inverse;
            if !side.has(end[1]) || plant.meets_barrier(state, end[0], end[1]) {
                break;
            }
            x = end;
            [state.position, state.velocity] = end;
            state.time_s += push.lasts_s;
            seen[next] = end[0];
            next += 1;
        }
        next
    }

    /// Two masses, whichever of them are held.
    fn coast_linked(
        &mut self,
        state: &mut State,
        course: &Course,
        from: usize,
        seen: &mut [f64],
    ) -> usize {
        let plant = self.plant;
        let m = &plant.mechanics;
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
            return from;
        }
        let Some(until_s) = self.until_s(state) else {
            return from;
        };
        let step_s = self.step_s;
        let link = &plant.parts.link;
        let flank = link.flank(x[0] - x[2], x[1] - x[3]);
        let held = sides.map(|side| side == Side::Held);
        let is_linear = self.is_linear;
        let flow = &*self.two_masses[flow_index(flank, held)]
            .get_or_insert_with(|| Box::new(plant.two_masses_held(flank, held, step_s)));
        let (stiffness, damping, relaxed) = link.spring(flank);
        let directions = sides.map(Side::direction);
        let constant_friction = |side: usize| {
            let direction = directions[side];
            plant.constant_friction_nm(side, direction).unwrap_or(0.0)
        };
        let constant_nm = [
            m.offset_nm + stiffness * relaxed - constant_friction(0),
            m.stiffness * m.stiffness_zero - stiffness * relaxed - constant_friction(1),
        ];
        let bent = [0, 1].map(|side| Bent::of(plant, side, directions[side]));
        let varies = bent.iter().any(|bent| bent.varies);
        let mut pendulum = state.pendulum;
        let mut bent_nm = |x: &[f64; 4], time_s: f64, drive_nm: f64| {
            if is_linear {
                return [0.0; 2];
            }
            [
                bent[0].motor(x[0], x[1], time_s, drive_nm),
                bent[1].gravity(&mut pendulum, x[2])
                    - bent[1].resists(x[2], x[3], time_s, drive_nm),
            ]
        };
        // Whether what is held stays so, with what is `bent` there.
        let sticks = |state: &State, x: &[f64; 4], push: &Push, bent_nm: [f64; 2]| {
            let through_nm = stiffness * (x[0] - x[2]) + damping * (x[1] - x[3]);
            let motor_sticks = |drive_nm: f64| {
                let pull = drive_nm + constant_nm[0] + bent_nm[0] - through_nm;
                pull.abs() <= plant.holding(state, pull, drive_nm)
            };
            let load_sticks = || {
                let pull = constant_nm[1] + bent_nm[1] + through_nm - m.stiffness * x[2];
                pull.abs() <= plant.load_holding(state, pull, push.means_nm[0])
            };
            (!held[0] || push.bounds_nm.into_iter().all(motor_sticks))
                && (!held[1] || load_sticks())
        };
        let is_held = held[0] || held[1];
        // Near what acted over the step before, which is near enough for the way halfway.
        let mut before_nm = None;
        let mut next = from;
        while next < course.steps() {
            let push = course.push(next);
            if !is_usual(push, step_s) || state.time_s + push.lasts_s > until_s {
                break;
            }
            if varies && plant.is_steep(state, push) {
                break;
            }
            let [mean_nm, early_nm] = push.means_nm;
            let first_nm = match before_nm.filter(|_| !is_held) {
                Some(before_nm) => before_nm,
                None => bent_nm(&x, state.time_s, mean_nm),
            };
            if is_held && !sticks(state, &x, push, first_nm) {
                break;
            }
            let forces = |bent_nm: [f64; 2]| {
                [
                    constant_nm[0] + mean_nm + bent_nm[0],
                    constant_nm[1] + bent_nm[1],
                ]
            };
            let midway = || flow.half.of(&x, &forces(first_nm));
            let mut acting_nm = first_nm;
            if !is_linear {
                let midway = midway();
                if !have(&midway) {
                    break;
                }
                acting_nm = bent_nm(&midway, state.time_s + 0.5 * step_s, mean_nm);
            }
            let mut end = after(flow, push, &x, &forces(acting_nm));
            if is_linear {
                let stopped =
                    |side: usize| sides[side].may_have_stopped(x[2 * side + 1], end[2 * side + 1]);
                if (stopped(0) || stopped(1)) && !have(&midway()) {
                    break;
                }
            }
            if !held[0] {
                // A torque that comes early moves the motor farther.
                let ahead = (early_nm - mean_nm) * plant.inverse_inertia[0];
                end[0] += 0.5 * step_s * step_s * ahead;
            }
            let leaves = link.guard(flank, end[0] - end[2], end[1] - end[3]) < 0.0;
            if leaves
                || !have(&end)
                || plant.meets_barrier(state, end[2], end[3])
                || is_held && !sticks(state, &end, push, bent_nm(&end, state.time_s, mean_nm))
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
            state.time_s += push.lasts_s;
            seen[next] = if link.sensor_on_load { end[2] } else { end[0] };
            next += 1;
        }
        state.pendulum = pendulum;
        if next > from {
            for (phase, held) in [&mut state.phase, &mut state.load_phase]
                .into_iter()
                .zip(held)
            {
                if held {
                    *phase = Phase::Stick;
                }
            }
        }
        next
    }
}

/// True if a step takes about as long as most do.
#[inline]
fn is_usual(push: &Push, step_s: f64) -> bool {
    (push.lasts_s - step_s).abs() <= NEAR_USUAL * step_s
}

/// A state after a step under forces that are held.
#[inline(always)]
fn after<const D: usize, const S: usize>(
    flow: &ZeroOrderHold<D, S>,
    push: &Push,
    x: &[f64; D],
    forces: &[f64; S],
) -> [f64; D] {
    let end = flow.whole.of(x, forces);
    let late_s = push.lasts_s - flow.step_s;
    if late_s.abs() <= SAME * flow.step_s {
        end
    } else {
        flow.soon(&end, forces, late_s)
    }
}

impl Plant {
    /// True if static friction that falls with speed is too steep for a step.
    #[inline]
    fn is_steep(&self, state: &State, push: &Push) -> bool {
        push.lasts_s > self.longest_on_slope(state, push.means_nm[0], 0.0)
    }

    /// 1/(kg m²), of the lighter side.
    fn highest_mobility(&self) -> f64 {
        let [motor, load] = self.inverse_inertia;
        motor.max(load)
    }

    /// The linear flow of one mass.
    fn one_mass_held(&self, step_s: f64) -> ZeroOrderHold<2, 1> {
        let m = &self.mechanics;
        let inverse = self.inverse_inertia[0];
        let rates = [[0.0, -m.stiffness * inverse], [1.0, -m.viscous * inverse]];
        ZeroOrderHold::new(rates, [[0.0, inverse]], step_s)
    }

    /// The linear flow of two masses within a flank of their link, `held` on the motor side or the load side.
    fn two_masses_held(
        &self,
        flank: super::link::Flank,
        held: [bool; 2],
        step_s: f64,
    ) -> ZeroOrderHold<4, 2> {
        let m = &self.mechanics;
        let mobility = |side: usize| {
            if held[side] {
                0.0
            } else {
                self.inverse_inertia[side]
            }
        };
        let [motor, load] = [mobility(0), mobility(1)];
        let (stiffness, damping, _) = self.parts.link.spring(flank);
        let viscous = self.friction_share.map(|share| share * m.viscous);
        let rates = [
            [0.0, -motor * stiffness, 0.0, load * stiffness],
            [1.0, -motor * (damping + viscous[0]), 0.0, load * damping],
            [
                0.0,
                motor * stiffness,
                0.0,
                -load * (stiffness + m.stiffness),
            ],
            [0.0, motor * damping, 1.0, -load * (damping + viscous[1])],
        ];
        let inputs = [[0.0, motor, 0.0, 0.0], [0.0, 0.0, 0.0, load]];
        ZeroOrderHold::new(rates, inputs, step_s)
    }

    /// True if what carries the barriers has come into one, or out of one.
    #[inline]
    pub(super) fn meets_barrier(&self, state: &State, position: f64, velocity: f64) -> bool {
        let meets = |(barrier, touch): (&Barrier, &Touch)| {
            barrier.is_there(state.time_s) && barrier.guard(*touch, position, velocity) < 0.0
        };
        self.parts.barriers.iter().zip(&state.touch).any(meets)
    }
}
