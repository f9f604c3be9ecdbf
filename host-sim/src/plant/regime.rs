//! Stick, slip and contact as regimes of a smooth flow, and the events between them.

use super::event::{self, Flow};
use super::link::Flank;
use super::pendulum::Pendulum;
use super::runge_kutta::rk4;
use super::stribeck::Stride;
use super::two_mass::TwoMass;
use super::{BARRIERS, Mechanics, Phase, Plant, Rest, State, Torque, Touch};

/// A joint that is about to break away is held for this share of a step at least, or rounding could
/// hold it for ever.
const LEAST_HOLD: f64 = 1e-6;

/// Angle of an oscillation that a cubic follows within a thousandth.
const MOST_ON_A_CUBIC: f64 = 0.8;

/// Within one regime. The state is `[position, velocity]` of the motor side, then, for N of 4 and 5,
/// those of the load side, then, for odd N, the deflection of the bristles.
struct Regime<'a, const N: usize> {
    plant: &'a Plant,
    torque: &'a Torque,
    pendulum: Pendulum,
    time_s: f64,
    /// By which velocities are made positions, s.
    step_s: f64,
    /// Of sliding: ±1; 0 where dry friction has no kink here.
    direction: f64,
    held: bool,
    load: LoadSide,
    constant_friction_nm: Option<f64>,
    /// The link, where it is stepped in closed form.
    closed: Option<Closed<'a>>,
    touch: &'a [Touch; BARRIERS],
}

/// The load side of a link as far as dry friction goes.
struct LoadSide {
    direction: f64,
    held: bool,
    constant_friction_nm: Option<f64>,
}

/// A link that bounds the regime by its flanks, and is linear within.
struct Closed<'a> {
    flank: Flank,
    masses: &'a TwoMass,
}

const fn is_linked(n: usize) -> bool {
    n >= 4
}

const fn has_bristles(n: usize) -> bool {
    n % 2 == 1
}

impl Mechanics {
    /// Friction that grows with velocity, N m.
    #[inline(always)]
    pub(super) fn drag(&self, velocity: f64) -> f64 {
        (self.viscous + self.drag * velocity.abs()) * velocity
    }
}

impl Plant {
    /// What acts where the motor is, dry friction apart, N m.
    #[inline(always)]
    pub(super) fn motor_side(&self, drive_nm: f64, position: f64) -> f64 {
        let torque = drive_nm + self.mechanics.offset_nm;
        if self.parts.has_cogging {
            torque + self.parts.cogging.torque(position)
        } else {
            torque
        }
    }

    /// What acts where the load is, N m.
    #[inline(always)]
    pub(super) fn load_side(
        &self,
        pendulum: &Pendulum,
        touch: &[Touch; BARRIERS],
        position: f64,
        velocity: f64,
    ) -> f64 {
        let m = &self.mechanics;
        let mut torque = -m.stiffness * (position - m.stiffness_zero);
        if m.gravity != 0.0 {
            torque -= m.gravity * pendulum.sin(position - m.gravity_zero);
        }
        for (barrier, touch) in self.parts.barriers.iter().zip(touch) {
            torque += barrier.torque(*touch, position, velocity);
        }
        torque
    }

    /// Through the link, if there is one, from the motor side on the load side, N m.
    #[inline]
    fn through(&self, state: &State) -> f64 {
        if !self.parts.has_link {
            return 0.0;
        }
        let twist = state.position - state.load_position;
        let rate = state.velocity - state.load_velocity;
        self.parts.link.torque(twist, rate)
    }

    /// On the motor side, all but dry friction, with what goes `through` the link, N m.
    #[inline]
    fn pull(&self, state: &State, drive_nm: f64, through: f64) -> f64 {
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

    /// Likewise, on the load side, N m.
    #[inline]
    fn load_pull(&self, state: &State, through: f64) -> f64 {
        let (position, velocity) = (state.load_position, state.load_velocity);
        through + self.load_side(&state.pendulum, &state.touch, position, velocity)
            - self.friction_share[1] * self.mechanics.drag(velocity)
    }
}

impl Plant {
    /// The phase that follows on rest under this drive.
    #[inline]
    fn phase_at_rest(&self, state: &State, drive_nm: f64) -> Phase {
        let pull = self.pull(state, drive_nm, self.through(state));
        if pull.abs() <= self.holding(state, pull, drive_nm) {
            Phase::Stick
        } else {
            Phase::sliding(pull)
        }
    }

    /// Likewise, of the load side.
    #[inline]
    fn load_phase_at_rest(&self, state: &State, drive_nm: f64) -> Phase {
        let pull = self.load_pull(state, self.through(state));
        if pull.abs() <= self.load_holding(state, pull, drive_nm) {
            Phase::Stick
        } else {
            Phase::sliding(pull)
        }
    }

    /// Level that holds the load side against `pull` at rest, N m.
    #[inline]
    pub(super) fn load_holding(&self, state: &State, pull: f64, drive_nm: f64) -> f64 {
        let direction = if pull >= 0.0 { 1.0 } else { -1.0 };
        let friction = &self.mechanics.friction;
        self.friction_share[1]
            * friction.holding(direction, state.load_position, state.time_s, drive_nm)
    }

    /// True if the load side has dry friction of its own.
    #[inline]
    pub(super) fn load_is_dry(&self) -> bool {
        self.dry && self.friction_share[1] > 0.0
    }

    /// Level that holds against `pull` at rest, N m.
    #[inline]
    pub(super) fn holding(&self, state: &State, pull: f64, drive_nm: f64) -> f64 {
        let friction = &self.mechanics.friction;
        self.friction_share[0]
            * if self.plain {
                friction.level(pull)
            } else {
                let direction = if pull >= 0.0 { 1.0 } else { -1.0 };
                friction.holding(direction, state.position, state.time_s, drive_nm)
            }
    }

    /// Dry friction on the motor side (0) or the load side (1) while sliding, if it depends on the direction alone, N m.
    #[inline]
    pub(super) fn constant_friction_nm(&self, side: usize, direction: f64) -> Option<f64> {
        let level = self.mechanics.friction.level(direction);
        (self.plain || direction == 0.0).then_some(self.friction_share[side] * direction * level)
    }

    /// Carries `state` over `dt_s` under `torque`.
    #[inline]
    pub fn advance(&self, state: &mut State, torque: Torque, dt_s: f64) {
        let rests = !self.passing_barriers && self.stays_at_rest(state, torque.bounds(dt_s));
        if rests || self.glides(state, &torque, dt_s) {
            state.time_s += dt_s;
            return;
        }
        match (self.parts.has_link, self.parts.has_bristles) {
            (false, false) => self.advance_as::<2>(state, torque, dt_s),
            (false, true) => self.advance_as::<3>(state, torque, dt_s),
            (true, false) => self.advance_as::<4>(state, torque, dt_s),
            (true, true) => self.advance_as::<5>(state, torque, dt_s),
        }
    }

    #[inline(never)]
    fn advance_as<const N: usize>(&self, state: &mut State, mut torque: Torque, dt_s: f64) {
        let end_s = state.time_s + dt_s;
        let shortest_s = dt_s / self.pace.most_divisions;
        let mut left = dt_s;
        let mut events = 0;
        while left > 0.0 {
            let piece = self.until_barriers_change(state, left);
            if state.velocity == 0.0 && self.dry && !has_bristles(N) {
                state.phase = self.phase_at_rest(state, torque.at(0.0));
            }
            if is_linked(N) && self.load_is_dry() && state.load_velocity == 0.0 {
                state.load_phase = self.load_phase_at_rest(state, torque.at(0.0));
            }
            let taken = if state.phase == Phase::Stick && self.dry && !is_linked(N) {
                events += 1;
                if events > self.pace.most_events {
                    piece
                } else {
                    self.hold(state, &torque, piece)
                        .max(LEAST_HOLD * dt_s)
                        .min(piece)
                }
            } else {
                let closed = self.is_closed::<N>(state);
                let longest = self
                    .longest_step(state, torque.at(0.0), closed)
                    .min(torque.longest_step());
                let h = piece.min(longest.max(shortest_s));
                let bends = if has_bristles(N) && state.phase == Phase::Bristle {
                    let bristles = &self.parts.bristles;
                    bristles.longest_step(state.velocity, state.deflection)
                } else {
                    f64::INFINITY
                };
                let followed = h.min(bends.max(shortest_s));
                let watched = events < self.pace.most_events;
                let (taken, event) = self.flow::<N>(state, &torque, followed, watched, closed);
                let event = event || has_bristles(N) && self.slides_on(state, h);
                events += usize::from(event);
                taken
            };
            left -= taken;
            state.time_s += taken;
            if left > 0.0 {
                torque = torque.after(taken);
            }
        }
        state.time_s = end_s;
    }

    /// Time to the next coming or going of a barrier, `left` at most; what has just come or gone is
    /// taken in.
    #[inline]
    pub(super) fn until_barriers_change(&self, state: &mut State, left: f64) -> f64 {
        if !self.passing_barriers {
            return left;
        }
        self.touch(state);
        let changes = self
            .parts
            .barriers
            .iter()
            .map(|b| b.next_change(state.time_s));
        let next = changes.fold(f64::INFINITY, f64::min);
        // An instant that rounding cannot tell from now is stepped over.
        left.min((next - state.time_s).max(f64::EPSILON * next.abs().min(1e9)))
    }

    /// True if the joint is at rest and no drive between two bounds breaks it away.
    #[inline]
    pub(super) fn stays_at_rest(&self, state: &mut State, [low, high]: [f64; 2]) -> bool {
        if !(self.rest_is_steady && state.phase == Phase::Stick && state.velocity == 0.0) {
            return false;
        }
        if state.rest.position != state.position {
            state.rest = Rest {
                position: state.position,
                pull_nm: self.pull(state, 0.0, self.through(state)),
            };
        }
        let holds = |drive_nm: f64| {
            let pull = state.rest.pull_nm + drive_nm;
            pull.abs() <= self.holding(state, pull, drive_nm)
        };
        holds(low) && (low == high || holds(high))
    }

    /// At rest: until the end of the step, or until a drive that grows within it breaks away.
    fn hold(&self, state: &State, torque: &Torque, left: f64) -> f64 {
        let breaks_at = |t: f64| {
            let later = State {
                time_s: state.time_s + t,
                ..*state
            };
            self.phase_at_rest(&later, torque.at(t)) != Phase::Stick
        };
        if !breaks_at(left) {
            return left;
        }
        // The drive is monotone within a step, so that it breaks away once at most.
        let (mut held, mut broken) = (0.0, left);
        loop {
            let t = 0.5 * (held + broken);
            if t <= held || t >= broken {
                return broken;
            }
            if breaks_at(t) {
                broken = t;
            } else {
                held = t;
            }
        }
    }

    /// True if both masses are stepped in closed form, as far as the link goes: all else is slow then.
    #[inline]
    fn is_closed<const N: usize>(&self, state: &State) -> bool {
        self.pace.closed_link
            && is_linked(N)
            && !has_bristles(N)
            && !state.touch.contains(&Touch::Pushing)
    }

    /// The link within its present flank, `held` on the motor side or the load side.
    fn closed_link(&self, state: &State, held: [bool; 2]) -> Closed<'_> {
        let flank = self.parts.link.flank(
            state.position - state.load_position,
            state.velocity - state.load_velocity,
        );
        Closed {
            flank,
            masses: self.link_modes.within(flank, held),
        }
    }

    /// In motion: until `h` or the first event; the time taken, and whether by an event.
    #[inline]
    fn flow<const N: usize>(
        &self,
        state: &mut State,
        torque: &Torque,
        h: f64,
        watch: bool,
        closed: bool,
    ) -> (f64, bool) {
        let m = &self.mechanics;
        let kinked = self.dry && state.phase != Phase::Bristle;
        let direction = if self.dry {
            state.phase.direction()
        } else {
            0.0
        };
        let load_dry = is_linked(N) && self.load_is_dry();
        let load_direction = if load_dry {
            state.load_phase.direction()
        } else {
            0.0
        };
        let load = LoadSide {
            direction: load_direction,
            held: load_dry && state.load_phase == Phase::Stick,
            constant_friction_nm: self.constant_friction_nm(1, load_direction),
        };
        let held = kinked && state.phase == Phase::Stick;
        let load_position = if is_linked(N) {
            state.load_position
        } else {
            state.position
        };
        state.pendulum.follow(load_position - m.gravity_zero);
        let regime = Regime::<N> {
            plant: self,
            torque,
            pendulum: state.pendulum,
            time_s: state.time_s,
            step_s: h,
            direction,
            held,
            closed: closed.then(|| self.closed_link(state, [held, load.held])),
            load,
            constant_friction_nm: self.constant_friction_nm(0, direction),
            touch: &state.touch,
        };
        let tolerance = watch.then_some(self.pace.event_tolerance);
        let step = event::advance(&regime, &pack::<N>(state), h, tolerance);
        unpack(&step.x, state);
        if !watch {
            state.time_s += step.taken;
            self.enter(state);
            state.time_s -= step.taken;
            return (step.taken, false);
        }
        if step.event {
            if direction != 0.0 && state.velocity * direction <= 0.0 {
                state.velocity = 0.0;
                state.phase = Phase::Stick;
                if has_bristles(N) {
                    state.phase = Phase::Bristle;
                    state.deflection = direction * self.parts.bristles.distance;
                }
            }
            if load_direction != 0.0 && state.load_velocity * load_direction <= 0.0 {
                state.load_velocity = 0.0;
                state.load_phase = Phase::Stick;
            }
            state.time_s += step.taken;
            self.touch(state);
            state.time_s -= step.taken;
        }
        (step.taken, step.event)
    }

    /// Takes bristles that have bent all the way for sliding, if they would relax faster than a step of `step_s` follows.
    #[inline]
    pub(super) fn slides_on(&self, state: &mut State, step_s: f64) -> bool {
        let bristles = &self.parts.bristles;
        let slides = state.phase == Phase::Bristle
            && bristles.has_slid(state.velocity, state.deflection, step_s);
        if slides {
            state.phase = Phase::sliding(state.velocity);
        }
        slides
    }

    /// The longest step that follows how friction falls with speed, s.
    #[inline]
    pub(super) fn longest_on_slope(&self, state: &State, drive_nm: f64, stride: Stride) -> f64 {
        let Some([motor, load]) = &self.slopes else {
            return f64::INFINITY;
        };
        let through = self.through(state);
        let pull = self.pull(state, drive_nm, through);
        let of_motor = motor.longest_step(state.velocity.abs(), pull, stride);
        if !self.load_is_dry() || state.load_phase == Phase::Stick {
            return of_motor;
        }
        let pull = self.load_pull(state, through);
        of_motor.min(load.longest_step(state.load_velocity.abs(), pull, stride))
    }

    /// The longest step that the stiffest part in action allows, s.
    #[inline]
    fn longest_step(&self, state: &State, drive_nm: f64, closed: bool) -> f64 {
        let m = &self.mechanics;
        let mut longest = if closed {
            self.longest_closed_step_s
        } else {
            self.longest_step_s
        };
        for (touch, barrier) in state.touch.iter().zip(&self.parts.barriers) {
            if *touch == Touch::Pushing {
                let natural = (barrier.stiffness * self.inverse_inertia[1]).sqrt();
                let damped = barrier.damping * self.inverse_inertia[1];
                longest = longest.min(self.pace.rate_step / (natural + damped));
            }
        }
        longest = longest.min(self.longest_on_slope(state, drive_nm, self.pace.on_slope));
        if state.phase == Phase::Bristle {
            let level = m.friction.highest_nm();
            let holding = level * m.friction.stribeck.ratio;
            // The bristles' own relaxation is slower than a step, or they count as sliding.
            let motor_inertia = self.inverse_inertia[0].recip();
            let rate = self.parts.bristles.fastest_rate(motor_inertia, holding);
            longest = longest.min(2.0 * self.pace.rate_step / rate);
        }
        longest
    }
}

#[inline]
fn pack<const N: usize>(state: &State) -> [f64; N] {
    core::array::from_fn(|i| match i {
        0 => state.position,
        1 => state.velocity,
        2 if is_linked(N) => state.load_position,
        3 => state.load_velocity,
        _ => state.deflection,
    })
}

#[inline]
fn unpack<const N: usize>(x: &[f64; N], state: &mut State) {
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

impl<const N: usize> Regime<'_, N> {
    /// Dry friction while sliding or on bristles, N m; and the rate of the bristles.
    #[inline(always)]
    fn friction(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> (f64, f64) {
        let m = &self.plant.mechanics;
        let (position, velocity) = (x[0], x[1]);
        let sliding = |direction: f64| {
            let time_s = self.time_s + t;
            m.friction
                .sliding(direction, position, velocity.abs(), time_s, drive_nm)
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

    /// Dry friction of the load side while sliding, N m.
    #[inline]
    fn load_friction(&self, t: f64, drive_nm: f64, x: &[f64; N]) -> f64 {
        self.load.constant_friction_nm.unwrap_or_else(|| {
            let direction = self.load.direction;
            let friction = &self.plant.mechanics.friction;
            let time_s = self.time_s + t;
            let level = friction.sliding(direction, x[2], x[3].abs(), time_s, drive_nm);
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

    /// Position and velocity of what carries the barriers.
    #[inline]
    fn load(x: &[f64; N]) -> (f64, f64) {
        if is_linked(N) {
            (x[2], x[3])
        } else {
            (x[0], x[1])
        }
    }

    /// Through the link, if there is one, from the motor side on the load side, N m: in closed form that of the flank of
    /// this regime, also past its end, where it jumps.
    #[inline(always)]
    fn through(&self, x: &[f64; N]) -> f64 {
        match &self.closed {
            _ if !is_linked(N) => 0.0,
            Some(closed) => closed.masses.torque(&core::array::from_fn(|i| x[i])),
            None => self.plant.parts.link.torque(x[0] - x[2], x[1] - x[3]),
        }
    }

    /// What acts on motor side and load side, the link apart, N m, and the rate of the bristles. Without a link
    /// all of it acts on the motor side.
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

    /// The link in closed form, what else acts as it does halfway: the exponential midpoint rule (Hochbruck and
    /// Ostermann, Acta Numerica 19, 2010).
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
        let (forces, _) = self.forces(0.5 * t, self.torque.means(t)[0], &midway);
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
}

impl<const N: usize> Flow<N> for Regime<'_, N> {
    #[inline(always)]
    fn rate(&self, t: f64, x: &[f64; N]) -> [f64; N] {
        let (forces, bristle_rate) = self.forces(t, self.torque.at(t), x);
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

    #[inline]
    fn carried(&self, x: &[f64; N], rate: &[f64; N], t: f64) -> ([f64; N], [f64; N]) {
        match &self.closed {
            Some(closed) if is_linked(N) => self.in_closed_form(closed.masses, x, rate, t),
            _ => rk4(|t, x| self.rate(t, x), x, rate, t),
        }
    }

    #[inline]
    fn is_nearly_cubic(&self, h: f64) -> bool {
        let bends = match &self.closed {
            Some(closed) => closed.masses.angle(h) > MOST_ON_A_CUBIC,
            None => false,
        };
        self.plant.pace.cubic_events && !bends
    }

    #[inline(always)]
    fn guard(&self, t: f64, x: &[f64; N]) -> f64 {
        // All in one unit, or the smallest would hide the others until the end.
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
