//! A step of the plant, from event to event.

use super::event;
use super::regime::{Manner, Regime, Scheme, has_bristles, is_linked, pack, unpack};
use super::stiff;
use super::stribeck::Stride;
use super::{Phase, Plant, State, Torque, Touch};

/// Shortest rest, as a share of a step. Without it, a plant that breaks away at once would stop the step for ever.
const LEAST_HOLD: f64 = 1e-6;

/// Longest step over which the torque of a law is held, s. Predictions are compared with samples about as far apart.
const LAW_STEP_S: f64 = 1e-3;

impl Plant {
    /// Carries `state` over `dt_s` under `torque`.
    #[inline]
    pub fn advance(&self, state: &mut State, torque: Torque, dt_s: f64) {
        if self.mechanics.laws.is_empty() {
            self.advance_by_parts(state, torque, dt_s);
        } else {
            self.advance_under_laws(state, torque, dt_s);
        }
    }

    /// Carries `state` over `dt_s`. The torque of each law is held over steps of [`LAW_STEP_S`] at most.
    fn advance_under_laws(&self, state: &mut State, mut torque: Torque, dt_s: f64) {
        let steps = (dt_s / LAW_STEP_S).ceil().max(1.0);
        let step_s = dt_s / steps;
        for _ in 0..steps as usize {
            let motion = [state.position, state.velocity];
            let drive_nm = torque.at(0.5 * step_s);
            let by_laws = self
                .mechanics
                .by_laws(motion, drive_nm, state.time_s, step_s);
            self.advance_by_parts(state, torque.beside(by_laws), step_s);
            torque = torque.after(step_s);
        }
    }

    /// Carries `state` over `dt_s` under everything but the laws.
    #[inline]
    fn advance_by_parts(&self, state: &mut State, torque: Torque, dt_s: f64) {
        let rests = !self.is_timed && self.stays_at_rest(state, torque.bounds(dt_s), dt_s);
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
            let piece = self.until_change(state, left);
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
                let (manner, longest) = self.manner::<N>(state, &torque, piece, shortest_s);
                let on_slope = self.longest_on_slope(state, torque.at(0.0), self.pace.on_slope);
                let longest = longest.min(on_slope);
                let (shortest_s, most_events) = match manner.scheme {
                    Scheme::Stiff => (dt_s / stiff::MOST_DIVISIONS, stiff::MOST_EVENTS),
                    _ => (shortest_s, self.pace.most_events),
                };
                let h = piece.min(longest.max(shortest_s));
                let bends = if has_bristles(N) && state.phase == Phase::Bristle {
                    let bristles = &self.parts.bristles;
                    bristles.longest_step(state.velocity, state.deflection)
                } else {
                    f64::INFINITY
                };
                let followed = h.min(bends.max(shortest_s));
                let watched = events < most_events;
                let (taken, event) = self.flow::<N>(state, &torque, followed, watched, manner);
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

    /// Time until a barrier next comes or goes or the friction steps, s, `left` at most. Updates the contacts first.
    #[inline]
    pub(super) fn until_change(&self, state: &mut State, left: f64) -> f64 {
        if !self.is_timed {
            return left;
        }
        self.touch(state);
        let changes = self
            .parts
            .barriers
            .iter()
            .map(|b| b.next_change(state.time_s));
        let step_s = self.friction_steps_s(state.time_s);
        let next = changes.fold(step_s, f64::min);
        // The step passes an instant that rounding cannot tell from now.
        left.min((next - state.time_s).max(f64::EPSILON * next.abs().min(1e9)))
    }

    /// Time of the next step of the friction level after `time_s`, s. It is infinite if there is none.
    #[inline]
    pub(super) fn friction_steps_s(&self, time_s: f64) -> f64 {
        let drift = self.mechanics.friction.drift.as_ref();
        drift.map_or(f64::INFINITY, |drift| drift.next_step(time_s))
    }

    /// True if the motion of the two masses on their link is stepped in closed form. Everything else is slow then.
    #[inline]
    fn is_closed<const N: usize>(&self, state: &State) -> bool {
        self.pace.closed_link
            && is_linked(N)
            && !has_bristles(N)
            && !state.touch.contains(&Touch::Pushing)
    }

    /// Steps a moving plant by `h` or to the first event. Returns the time that passed, s, and true if an event ended
    /// it.
    #[inline]
    fn flow<const N: usize>(
        &self,
        state: &mut State,
        torque: &Torque,
        h: f64,
        watch: bool,
        manner: Manner,
    ) -> (f64, bool) {
        let load_position = if is_linked(N) {
            state.load_position
        } else {
            state.position
        };
        state
            .pendulum
            .follow(self.mechanics.from_hanging_rad(load_position));
        let regime = Regime::<N>::of(self, state, torque, h, manner);
        let [direction, load_direction] = regime.directions();
        let tolerance = if manner.scheme == Scheme::Stiff {
            stiff::EVENT_TOLERANCE
        } else {
            self.pace.event_tolerance
        };
        let tolerance = watch.then_some(tolerance);
        let step = event::advance(&regime, &regime.given(&pack::<N>(state)), h, tolerance);
        let end = regime.seen(&step.x, step.taken);
        unpack(&end, state);
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

    /// Treats fully bent bristles as sliding if they would relax faster than a step of `step_s` can follow.
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

    /// The longest step that follows the fall of friction with speed, s.
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

    /// How the next `piece_s` of the motion are stepped, and the longest step that the stiffest part and the drive allow
    /// then, s. No step is shorter than `shortest_s`.
    #[inline]
    fn manner<const N: usize>(
        &self,
        state: &State,
        torque: &Torque,
        piece_s: f64,
        shortest_s: f64,
    ) -> (Manner, f64) {
        let closed = self.is_closed::<N>(state);
        let longest_s = self.longest_step(state, torque, closed);
        // For one mass an exact step costs no more than two classical ones.
        let least_s = if self.pace.closed_link && !is_linked(N) {
            stiff::BEYOND_CLASSICAL * piece_s
        } else {
            piece_s.min(shortest_s)
        };
        let is_quick = torque.longest_step() < piece_s.min(shortest_s);
        let fades = is_quick && torque.lag_s <= self.pace.short_lag * longest_s;
        if longest_s < least_s || is_quick && !fades {
            return (Manner::STIFF, self.longest_stiff_step(state, torque));
        }
        let scheme = if closed {
            Scheme::ClosedLink
        } else {
            Scheme::Classical
        };
        let of_drive_s = if fades {
            f64::INFINITY
        } else {
            torque.longest_step()
        };
        (Manner { scheme, fades }, longest_s.min(of_drive_s))
    }

    /// The longest step that the stiffest part in action allows, s.
    #[inline]
    fn longest_step(&self, state: &State, torque: &Torque, closed: bool) -> f64 {
        let m = &self.mechanics;
        let mut longest = if closed {
            self.longest_closed_step_s
        } else {
            self.longest_step_s
        };
        if m.drag != 0.0 {
            longest = longest.min(self.pace.rate_step / self.drag_rate(state, torque.at(0.0)));
        }
        for (touch, barrier) in state.touch.iter().zip(&self.parts.barriers) {
            if *touch == Touch::Pushing {
                let rate = barrier.rate(self.inverse_inertia[1]);
                longest = longest.min(self.pace.rate_step / rate);
            }
        }
        if state.phase == Phase::Bristle {
            let level = m.friction.highest_nm();
            let holding = level * m.friction.stribeck.ratio;
            // The bristles relax more slowly than a step, or they count as sliding.
            let motor_inertia = self.inverse_inertia[0].recip();
            let rate = self.parts.bristles.fastest_rate(motor_inertia, holding);
            longest = longest.min(2.0 * self.pace.rate_step / rate);
        }
        longest
    }
}
