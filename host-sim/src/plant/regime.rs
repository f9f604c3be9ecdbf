//! A regime: the smooth flow of the state as long as stick, slip and contact stay the same.

use super::event::Flow;
use super::fading::Fading;
use super::link::Flank;
use super::pendulum::Pendulum;
use super::presliding::Bending;
use super::runge_kutta::rk4;
use super::stiff::{self, Linear};
use super::two_mass::TwoMass;
use super::{BARRIERS, Phase, Plant, Rest, State, Torque, Touch};

/// Angle of an oscillation up to which the error of a cubic is below a thousandth, rad.
const MOST_ON_A_CUBIC: f64 = 0.8;

/// One regime. Its state is `[position, velocity]` of the motor side, then, for N of 4 and 5, those of the load side,
/// then, for odd N, the deflection of the bristles.
pub(super) struct Regime<'a, const N: usize> {
    plant: &'a Plant,
    torque: &'a Torque,
    pendulum: Pendulum,
    time_s: f64,
    /// Time of the next step of the friction level, s. The regime ends there.
    friction_steps_s: f64,
    /// Length of the step, s. Guards multiply velocities by it, so that they are positions.
    step_s: f64,
    /// Direction of sliding: ±1; 0 where dry friction has no kink.
    direction: f64,
    held: bool,
    load: LoadSide,
    constant_friction_nm: Option<f64>,
    /// The link, if it is stepped in closed form.
    closed: Option<Closed<'a>>,
    /// The linear part, if it is stiff and stepped exactly.
    stiff: Option<Linear>,
    /// The fading torque of the drive, if the state that is stepped has received all of it.
    fading: Option<Fading<N>>,
    touch: &'a [Touch; BARRIERS],
}

/// The dry friction on the load side of a link.
struct LoadSide {
    direction: f64,
    held: bool,
    constant_friction_nm: Option<f64>,
}

/// A link on one flank. It is linear there, and the regime ends with the flank.
struct Closed<'a> {
    flank: Flank,
    masses: &'a TwoMass,
}

impl<'a> Closed<'a> {
    /// The link on its present flank. Friction holds the motor side or the load side if `held` says so.
    #[inline]
    fn of(plant: &'a Plant, state: &State, held: [bool; 2]) -> Self {
        let flank = plant.parts.link.flank(
            state.position - state.load_position,
            state.velocity - state.load_velocity,
        );
        Self {
            flank,
            masses: plant.link_modes.within(flank, held),
        }
    }
}

/// The method by which a regime is stepped.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Scheme {
    /// The classical Runge-Kutta method.
    Classical,
    /// The link in closed form. Everything else is slow.
    ClosedLink,
    /// The linear part exactly.
    Stiff,
}

/// How a regime and its drive are stepped.
#[derive(Clone, Copy)]
pub(super) struct Manner {
    pub scheme: Scheme,
    /// True if the fading torque of the drive is given to the masses at once.
    pub fades: bool,
}

impl Manner {
    pub(super) const STIFF: Self = Self {
        scheme: Scheme::Stiff,
        fades: false,
    };
}

pub(super) const fn is_linked(n: usize) -> bool {
    n >= 4
}

pub(super) const fn has_bristles(n: usize) -> bool {
    n % 2 == 1
}

#[inline]
pub(super) fn pack<const N: usize>(state: &State) -> [f64; N] {
    core::array::from_fn(|i| match i {
        0 => state.position,
        1 => state.velocity,
        2 if is_linked(N) => state.load_position,
        3 => state.load_velocity,
        _ => state.deflection,
    })
}

#[inline]
pub(super) fn unpack<const N: usize>(x: &[f64; N], state: &mut State) {
    state.position = x[0];
    state.velocity = x[1];
    if is_linked(N) {
        state.load_position = x[2];
        state.load_velocity = x[3];
    }
    if has_bristles(N) {
        state.deflection = x[N - 1];
    }
}

impl<'a, const N: usize> Regime<'a, N> {
    /// The regime of `state` under `torque`, for a step of `step_s`.
    #[inline]
    pub(super) fn of(
        plant: &'a Plant,
        state: &'a State,
        torque: &'a Torque,
        step_s: f64,
        manner: Manner,
    ) -> Self {
        let Manner { scheme, fades } = manner;
        let directed = |dry: bool, phase: Phase| if dry { phase.direction() } else { 0.0 };
        let direction = directed(plant.dry, state.phase);
        let held = plant.dry && state.phase == Phase::Stick;
        let load_dry = is_linked(N) && plant.load_is_dry();
        let load_direction = directed(load_dry, state.load_phase);
        let load = LoadSide {
            direction: load_direction,
            held: load_dry && state.load_phase == Phase::Stick,
            constant_friction_nm: plant.constant_friction_nm(1, load_direction),
        };
        let held_sides = [held, load.held];
        let bounded = scheme == Scheme::ClosedLink || scheme == Scheme::Stiff && is_linked(N);
        let closed = bounded.then(|| Closed::of(plant, state, held_sides));
        let stiff = (scheme == Scheme::Stiff).then(|| {
            let linked = closed.as_ref().map(|closed| (closed.flank, held_sides));
            Linear::of(plant, state, torque, linked)
        });
        let regime = Self {
            plant,
            torque,
            pendulum: state.pendulum,
            time_s: state.time_s,
            friction_steps_s: plant.friction_steps_s(state.time_s),
            step_s,
            direction,
            held,
            closed,
            stiff,
            fading: None,
            load,
            constant_friction_nm: plant.constant_friction_nm(0, direction),
            touch: &state.touch,
        };
        let fading = fades.then(|| {
            let under = |drive_nm: f64| regime.rate_under(0.0, drive_nm, &pack(state));
            let [all, rest] = [torque.at(0.0), torque.trailing_nm(0.0)].map(under);
            Fading::of(torque.lag_s, &all, &rest)
        });
        Self { fading, ..regime }
    }

    /// The state that is stepped, from the true state at the start of the step.
    #[inline]
    pub(super) fn given(&self, x: &[f64; N]) -> [f64; N] {
        self.fading.as_ref().map_or(*x, |fading| fading.given(x))
    }

    /// The true state `t` after the start of the step, from the state that is stepped.
    #[inline]
    pub(super) fn seen(&self, x: &[f64; N], t: f64) -> [f64; N] {
        self.fading.as_ref().map_or(*x, |fading| fading.seen(x, t))
    }

    /// Torque of the drive that acts on the state that is stepped, `t` after the start of the step, N m.
    #[inline]
    fn drive_nm(&self, t: f64) -> f64 {
        match self.fading {
            Some(_) => self.torque.trailing_nm(t),
            None => self.torque.at(t),
        }
    }

    /// Mean of that torque over the first `t` of the step, N m.
    #[inline]
    fn mean_drive_nm(&self, t: f64) -> f64 {
        match self.fading {
            Some(_) => self.torque.trailing_nm(0.5 * t),
            None => self.torque.means(t)[0],
        }
    }

    /// Directions in which motor side and load side slide: ±1; 0 where dry friction has no kink.
    #[inline]
    pub(super) fn directions(&self) -> [f64; 2] {
        [self.direction, self.load.direction]
    }

    /// Time at which the friction level is taken, `t` after the start of the step, s. A step of the level belongs to the
    /// next regime.
    #[inline]
    fn friction_time_s(&self, t: f64) -> f64 {
        (self.time_s + t).min(self.friction_steps_s.next_down())
    }

    /// Dry friction on the motor side while it slides or bends bristles, N m, and the rate of the bristles, rad/s.
    #[inline(always)]
    fn friction(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> (f64, f64) {
        let m = &self.plant.mechanics;
        let (position, velocity) = (x[0], x[1]);
        let sliding = |direction: f64| {
            let (speed, time_s) = (velocity.abs(), self.friction_time_s(t));
            m.sliding(direction, position, speed, time_s, drive_nm)
        };
        if has_bristles(N) && self.direction == 0.0 && self.plant.dry {
            let bristles = &self.plant.parts.bristles;
            let deflection = x[N - 1];
            let rate = bristles.rate(velocity, deflection);
            let level = sliding(if deflection >= 0.0 { 1.0 } else { -1.0 });
            let friction = level * deflection / bristles.distance + bristles.damping * rate;
            return (friction, rate);
        }
        let friction = self.constant_friction_nm.unwrap_or_else(|| {
            let share = self.plant.friction_share[0];
            share * self.direction * sliding(self.direction)
        });
        (friction, 0.0)
    }

    /// Dry friction on the load side while it slides, N m.
    #[inline]
    fn load_friction(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> f64 {
        self.load.constant_friction_nm.unwrap_or_else(|| {
            let direction = self.load.direction;
            let (m, time_s) = (&self.plant.mechanics, self.friction_time_s(t));
            let level = m.sliding(direction, x[2], x[3].abs(), time_s, drive_nm);
            self.plant.friction_share[1] * direction * level
        })
    }

    fn state_at(&self, x: &[f64; N]) -> State {
        let mut state = State {
            time_s: self.time_s,
            position: 0.0,
            velocity: 0.0,
            load_position: 0.0,
            load_velocity: 0.0,
            deflection: 0.0,
            phase: Phase::Stick,
            load_phase: Phase::Stick,
            touch: *self.touch,
            pendulum: self.pendulum,
            rest: Rest::UNKNOWN,
        };
        unpack(x, &mut state);
        state
    }

    /// Position and velocity of the side on which barriers act.
    #[inline]
    fn load(x: &[f64; N]) -> (f64, f64) {
        if is_linked(N) {
            (x[2], x[3])
        } else {
            (x[0], x[1])
        }
    }

    /// Torque from the motor side on the load side, N m; 0 without a link. In closed form it is that of the regime's
    /// flank, even past the end of the regime, where the true torque jumps.
    #[inline(always)]
    fn through(&self, x: &[f64; N]) -> f64 {
        match &self.closed {
            _ if !is_linked(N) => 0.0,
            Some(closed) => closed.masses.torque(&core::array::from_fn(|i| x[i])),
            None => self.plant.parts.link.torque(x[0] - x[2], x[1] - x[3]),
        }
    }

    /// Torques on motor side and load side without the link, N m, and the rate of the bristles, rad/s. Without a link
    /// everything acts on the motor side.
    #[inline(always)]
    fn forces(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> ([f64; 2], f64) {
        let m = &self.plant.mechanics;
        let share = self.plant.friction_share;
        let (load_position, load_velocity) = Self::load(x);
        let mut motor = self.plant.motor_side(drive_nm, x[0]);
        let mut load =
            self.plant
                .load_side(&self.pendulum, self.touch, load_position, load_velocity);
        if is_linked(N) {
            motor -= share[0] * m.drag(x[1]);
            load -= share[1] * m.drag(load_velocity) + self.load_friction(t, drive_nm, x);
        } else {
            motor += load - m.drag(x[1]);
        }
        let (friction, bristle_rate) = self.friction(t, drive_nm, x);
        ([motor - friction, load], bristle_rate)
    }

    /// A step of `t` with the link in closed form. All other torques are held at their values in the middle of the
    /// step: the exponential midpoint rule (Hochbruck and Ostermann, Acta Numerica 19, 2010).
    #[inline]
    fn in_closed_form(
        &self,
        masses: &TwoMass,
        x: &[f64; N],
        rate: &[f64; N],
        t: f64,
    ) -> ([f64; N], [f64; N]) {
        if self.held && self.load.held {
            return (*x, [0.0; N]);
        }
        let from = core::array::from_fn(|i| x[i]);
        let pulled = masses.accelerations(&from);
        let at_first = [rate[1] - pulled[0], rate[3] - pulled[1]];
        let half = masses.propagator(0.5 * t);
        let midway = masses.carried(&half, &from, at_first);
        let midway = core::array::from_fn(|i| midway[i]);
        let (forces, _) = self.forces(0.5 * t, self.mean_drive_nm(t), &midway);
        let accelerations = masses.pushed(forces);
        let end = masses.carried(&masses.twice(&half), &from, accelerations);
        let pulled = masses.accelerations(&end);
        let end_rate = [
            end[1],
            accelerations[0] + pulled[0],
            end[3],
            accelerations[1] + pulled[1],
        ];
        (
            core::array::from_fn(|i| end[i]),
            core::array::from_fn(|i| end_rate[i]),
        )
    }
    /// Time derivative of the state `x` under a drive, `t` after the start of the step.
    #[inline(always)]
    fn rate_under(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> [f64; N] {
        let (forces, bristle_rate) = self.forces(t, drive_nm, x);
        let through = self.through(x);
        let mut rate = [0.0; N];
        rate[0] = x[1];
        if !self.held {
            rate[1] = (forces[0] - through) * self.plant.inverse_inertia[0];
        }
        if is_linked(N) {
            rate[2] = x[3];
            if !self.load.held {
                rate[3] = (forces[1] + through) * self.plant.inverse_inertia[1];
            }
        }
        if has_bristles(N) {
            rate[N - 1] = bristle_rate;
        }
        rate
    }

    /// A step of `t` with the linear part exact. All other torques are held at their values in the middle of the step.
    #[inline(never)]
    fn exactly<const D: usize, const S: usize>(
        &self,
        rates: &[[f64; D]; D],
        x: &[f64; N],
        rate: &[f64; N],
        t: f64,
    ) -> ([f64; N], [f64; N]) {
        let accelerations = |rate: &[f64; N]| [rate[1], if is_linked(N) { rate[3] } else { 0.0 }];
        let bends = has_bristles(N) && self.direction == 0.0 && self.plant.dry;
        let at = |masses: &[f64; D]| {
            let mut there = *x;
            there[..D - 2].copy_from_slice(&masses[..D - 2]);
            if bends {
                let mut bending = Bending::from(&self.plant.parts.bristles, x[N - 1]);
                bending.go(there[0] - x[0]);
                there[N - 1] = bending.deflection();
            }
            there
        };
        let step = stiff::Step::<D, S>::new(rates, &x[..D - 2], self.torque, t);
        let mean_nm = self.torque.means(t)[0];
        let halfway = |masses: &[f64; D], drive_nm: f64| {
            accelerations(&self.rate_under(0.5 * t, drive_nm, &at(masses)))
        };
        let (end, masses_rate) = step.taken(rates, accelerations(rate), mean_nm, halfway);
        let mut end_rate = [0.0; N];
        end_rate[..D - 2].copy_from_slice(&masses_rate[..D - 2]);
        let end = at(&end);
        if bends {
            end_rate[N - 1] = self.plant.parts.bristles.rate(end[1], end[N - 1]);
        }
        (end, end_rate)
    }
}

impl<const N: usize> Flow<N> for Regime<'_, N> {
    #[inline(always)]
    fn rate(&self, t: f64, x: &[f64; N]) -> [f64; N] {
        self.rate_under(t, self.drive_nm(t), x)
    }

    #[inline]
    fn carried(&self, x: &[f64; N], rate: &[f64; N], t: f64) -> ([f64; N], [f64; N]) {
        match (&self.stiff, &self.closed) {
            (Some(Linear::One(rates)), _) => self.exactly::<4, 2>(rates, x, rate, t),
            (Some(Linear::Two(rates)), _) => self.exactly::<6, 3>(rates, x, rate, t),
            (None, Some(closed)) if is_linked(N) => self.in_closed_form(closed.masses, x, rate, t),
            _ => rk4(|t, x| self.rate(t, x), x, rate, t),
        }
    }

    #[inline]
    fn is_nearly_cubic(&self, h: f64) -> bool {
        let bends = match &self.closed {
            Some(closed) => closed.masses.angle(h) > MOST_ON_A_CUBIC,
            None => false,
        };
        self.plant.pace.cubic_events && !bends && self.stiff.is_none()
    }

    #[inline(always)]
    fn guard(&self, t: f64, x: &[f64; N]) -> f64 {
        let x = &self.seen(x, t);
        // All guards have one unit. Otherwise the smallest would hide the others.
        let far = |velocity: f64| self.step_s * velocity;
        let mut guard = if self.direction == 0.0 {
            f64::INFINITY
        } else {
            far(self.direction * x[1])
        };
        let (position, velocity) = Self::load(x);
        for (barrier, touch) in self.plant.parts.barriers.iter().zip(self.touch) {
            if barrier.is_there(self.time_s) {
                guard = guard.min(barrier.guard(*touch, position, velocity));
            }
        }
        if let Some(closed) = &self.closed
            && is_linked(N)
        {
            let link = &self.plant.parts.link;
            guard = guard.min(link.guard(closed.flank, x[0] - x[2], x[1] - x[3]));
        }
        if is_linked(N) && self.load.direction != 0.0 {
            guard = guard.min(far(self.load.direction * x[3]));
        }
        if is_linked(N) && (self.held || self.load.held) {
            let state = self.state_at(x);
            let drive_nm = self.torque.at(t);
            let through = self.through(x);
            let left = |holding: f64, pull: f64, side: usize| {
                far(far(
                    (holding - pull.abs()) * self.plant.inverse_inertia[side]
                ))
            };
            if self.held {
                let pull = self.plant.pull(&state, drive_nm, through);
                guard = guard.min(left(self.plant.holding(&state, pull, drive_nm), pull, 0));
            }
            if self.load.held {
                let pull = self.plant.load_pull(&state, through);
                let holding = self.plant.load_holding(&state, pull, drive_nm);
                guard = guard.min(left(holding, pull, 1));
            }
        }
        guard
    }

    #[inline]
    fn may_dip(&self, h: f64, x: [&[f64; N]; 2], rate: [&[f64; N]; 2]) -> bool {
        let seen = self.fading.as_ref().map(|fading| {
            let ends = [(x[0], rate[0], 0.0), (x[1], rate[1], h)];
            (
                ends.map(|(x, _, t)| fading.seen(x, t)),
                ends.map(|(_, rate, t)| fading.seen_rate(rate, t)),
            )
        });
        let (x, rate) = match &seen {
            Some((x, rate)) => (x.each_ref(), rate.each_ref()),
            None => (x, rate),
        };
        // The velocity can touch zero within a step only if it falls at first and rises at last; a
        // barrier can be touched and left only if the velocity turns.
        let dips = |direction: f64, v: usize| {
            let falls = |i: usize| direction * rate[i][v] < 0.0;
            let slowest = x[0][v].abs().min(x[1][v].abs());
            falls(0) && !falls(1) && slowest < h * rate[0][v].abs()
        };
        let dips = dips(self.direction, 1) || (is_linked(N) && dips(self.load.direction, 3));
        let (from, to) = (Self::load(x[0]).1, Self::load(x[1]).1);
        dips || (from * to < 0.0 && !self.plant.parts.barriers.is_empty())
    }
}
