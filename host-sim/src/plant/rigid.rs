//! One inertia: stick, slip and contact as regimes of a two-dimensional flow.

use super::runge_kutta::{self, Flow};
use super::{BARRIERS, Mechanics, Phase, Plant, RATE_STEP, State, Torque, Touch};

/// A step is never divided further than this, however stiff the plant.
const MOST_DIVISIONS: f64 = 256.0;

/// More events than this within one step are chatter of a degenerate plant (a static level below
/// the sliding one, say): the rest of the step is then taken as it is.
const MOST_EVENTS: usize = 64;

/// Where the sines are expanded about the start of a step, up to this angle (error below 1e-12).
const EXPANSION_LIMIT_RAD: f64 = 0.03;

/// `G sin(x)` near an angle, without a sine at every stage.
struct Pendulum {
    weight_nm: f64,
    angle: f64,
    sin: f64,
    cos: f64,
}

impl Pendulum {
    #[inline]
    fn about(mechanics: &Mechanics, position: f64) -> Self {
        let angle = position - mechanics.gravity_zero;
        let (sin, cos) = if mechanics.gravity != 0.0 {
            angle.sin_cos()
        } else {
            (0.0, 1.0)
        };
        Self {
            weight_nm: mechanics.gravity,
            angle: position,
            sin,
            cos,
        }
    }

    #[inline]
    fn torque(&self, position: f64) -> f64 {
        if self.weight_nm == 0.0 {
            return 0.0;
        }
        let d = position - self.angle;
        let sin = if d.abs() < EXPANSION_LIMIT_RAD {
            let d2 = d * d;
            let sin_d = d * (1.0 - d2 / 6.0 * (1.0 - d2 / 20.0));
            let cos_d = 1.0 - d2 / 2.0 * (1.0 - d2 / 12.0 * (1.0 - d2 / 30.0));
            self.sin * cos_d + self.cos * sin_d
        } else {
            let (sin_d, cos_d) = d.sin_cos();
            self.sin * cos_d + self.cos * sin_d
        };
        -self.weight_nm * sin
    }
}

/// Sliding in one direction, with a given set of contacts.
struct Sliding<'a> {
    plant: &'a Plant,
    torque: &'a Torque,
    pendulum: Pendulum,
    time_s: f64,
    direction: f64,
    plain_friction_nm: f64,
    inverse_inertia: f64,
    touch: &'a [Touch; BARRIERS],
}

impl Plant {
    /// All torques but dry friction, N m.
    #[inline]
    fn load(
        &self,
        drive_nm: f64,
        pendulum: &Pendulum,
        touch: &[Touch; BARRIERS],
        [position, velocity]: [f64; 2],
    ) -> f64 {
        let m = &self.mechanics;
        let mut torque = drive_nm + m.offset_nm
            - (m.viscous + m.drag * velocity.abs()) * velocity
            - m.stiffness * (position - m.stiffness_zero)
            + pendulum.torque(position);
        if let Some(cogging) = &m.cogging {
            torque += cogging.amplitude_nm * (cogging.wave_number * position + cogging.phase).sin();
        }
        for (barrier, touch) in m.barriers.iter().zip(touch) {
            if let Some(barrier) = barrier {
                torque += barrier.torque(*touch, position, velocity);
            }
        }
        torque
    }

    /// All torques but dry friction at a state, N m.
    #[inline]
    fn load_at(&self, state: &State, drive_nm: f64) -> f64 {
        let pendulum = Pendulum::about(&self.mechanics, state.position);
        self.load(
            drive_nm,
            &pendulum,
            &state.touch,
            [state.position, state.velocity],
        )
    }

    /// The phase that follows on rest under this drive.
    #[inline]
    fn phase_at_rest(&self, state: &State, drive_nm: f64) -> Phase {
        let load = self.load_at(state, drive_nm);
        let direction = if load >= 0.0 { 1.0 } else { -1.0 };
        let friction = &self.mechanics.friction;
        let holding = if self.plain {
            friction.level_nm[usize::from(load < 0.0)]
        } else {
            friction.holding(direction, state.position, state.time_s, drive_nm)
        };
        if load.abs() <= holding {
            Phase::Stick
        } else if load > 0.0 {
            Phase::Forward
        } else {
            Phase::Backward
        }
    }

    /// Carries `state` over `dt_s` under `torque`.
    #[inline]
    pub fn advance(&self, state: &mut State, torque: Torque, dt_s: f64) {
        let end_s = state.time_s + dt_s;
        let shortest_s = dt_s / MOST_DIVISIONS;
        let mut torque = torque;
        let mut left = dt_s;
        let mut events = 0;
        while left > 0.0 {
            if state.velocity == 0.0 && self.dry {
                state.phase = self.phase_at_rest(state, torque.at(0.0));
            }
            let taken = if state.phase == Phase::Stick && self.dry {
                self.hold(state, &torque, left)
            } else {
                let (taken, event) =
                    self.slide(state, &torque, left, shortest_s, events < MOST_EVENTS);
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

    /// At rest: until the end of the step, or until a drive that grows within it breaks away.
    fn hold(&self, state: &State, torque: &Torque, left: f64) -> f64 {
        let breaks_at = |t: f64| {
            let later = State {
                time_s: state.time_s + t,
                ..*state
            };
            self.phase_at_rest(&later, torque.at(t)) != Phase::Stick
        };
        let constant = torque.lag_s == 0.0 && self.mechanics.friction.drift_per_s == 0.0;
        if constant || !breaks_at(left) {
            return left;
        }
        // The drive is monotone within a step, so that it breaks away once at most.
        let (mut held, mut broken) = (0.0, left);
        while broken - held > f64::EPSILON * left.max(state.time_s.abs()) {
            let t = 0.5 * (held + broken);
            if breaks_at(t) {
                broken = t;
            } else {
                held = t;
            }
            if t == held && t == broken {
                break;
            }
        }
        broken
    }

    /// Sliding: until the end of the step or the first event; the time taken, and whether by one.
    #[inline]
    fn slide(
        &self,
        state: &mut State,
        torque: &Torque,
        left: f64,
        shortest_s: f64,
        watch: bool,
    ) -> (f64, bool) {
        let m = &self.mechanics;
        let h = left.min(
            self.longest_step(state)
                .min(torque.longest_step())
                .max(shortest_s),
        );
        let direction = if state.phase == Phase::Backward {
            -1.0
        } else {
            1.0
        };
        let sliding = Sliding {
            plant: self,
            torque,
            pendulum: Pendulum::about(m, state.position),
            time_s: state.time_s,
            direction: if self.dry { direction } else { 0.0 },
            plain_friction_nm: direction * m.friction.level_nm[usize::from(direction < 0.0)],
            inverse_inertia: 1.0 / m.inertia,
            touch: &state.touch,
        };
        let step = runge_kutta::advance(&sliding, &[state.position, state.velocity], h);
        let [position, velocity] = step.x;
        if !watch {
            *state = State {
                time_s: state.time_s,
                ..self.state(0.0, position, velocity)
            };
            return (step.taken, false);
        }
        state.position = position;
        state.velocity = velocity;
        if step.event {
            if self.dry && velocity * direction <= 0.0 {
                state.velocity = 0.0;
            }
            for (touch, barrier) in state.touch.iter_mut().zip(&m.barriers) {
                if let Some(barrier) = barrier {
                    *touch = barrier.touch(position, velocity);
                }
            }
        }
        (step.taken, step.event)
    }

    /// The longest step that the stiffest part in action allows, s.
    #[inline]
    fn longest_step(&self, state: &State) -> f64 {
        let m = &self.mechanics;
        let mut longest = self.longest_step_s;
        for (touch, barrier) in state.touch.iter().zip(&m.barriers) {
            if let (Touch::Pushing, Some(barrier)) = (touch, barrier) {
                let natural = (barrier.stiffness / m.inertia).sqrt();
                let damped = barrier.damping / m.inertia;
                longest = longest.min(RATE_STEP / (natural + damped));
            }
        }
        if !self.plain {
            longest = longest.min(
                m.friction
                    .longest_step(m.inertia, state.velocity, RATE_STEP),
            );
        }
        longest
    }
}

impl Flow<2> for Sliding<'_> {
    #[inline]
    fn rate(&self, t: f64, &[position, velocity]: &[f64; 2]) -> [f64; 2] {
        let drive_nm = self.torque.at(t);
        let load = self
            .plant
            .load(drive_nm, &self.pendulum, self.touch, [position, velocity]);
        let friction = if self.plant.plain || self.direction == 0.0 {
            self.plain_friction_nm
        } else {
            self.direction
                * self.plant.mechanics.friction.sliding(
                    self.direction,
                    position,
                    velocity.abs(),
                    self.time_s + t,
                    drive_nm,
                )
        };
        [velocity, (load - friction) * self.inverse_inertia]
    }

    #[inline]
    fn guard(&self, &[position, velocity]: &[f64; 2]) -> f64 {
        let mut guard = if self.direction == 0.0 {
            f64::INFINITY
        } else {
            self.direction * velocity
        };
        for (barrier, touch) in self.plant.mechanics.barriers.iter().zip(self.touch) {
            if let Some(barrier) = barrier {
                guard = guard.min(barrier.guard(*touch, position, velocity));
            }
        }
        guard
    }

    #[inline]
    fn may_dip(&self, h: f64, x: [&[f64; 2]; 2], rate: [&[f64; 2]; 2]) -> bool {
        // The velocity can touch zero within the step only if it falls at first and rises at last,
        // and a barrier can be touched only if the velocity turns.
        let falls = |i: usize| self.direction * rate[i][1] < 0.0;
        let dips =
            falls(0) && !falls(1) && (x[0][1].abs().min(x[1][1].abs()) < h * rate[0][1].abs());
        dips || (x[0][1] * x[1][1] < 0.0)
    }
}
