//! The true device, with everything that is hidden in it.
//!
//! Time stepping uses the midpoint rule with set-valued dry friction (Moreau, "Unilateral contact and dry friction in finite
//! freedom dynamics", 1988). Friction is the projection of the velocity that the mass would have without it. Sticking is
//! therefore exact and needs no event detection. Steps are tens of microseconds. Nothing here is shared with the simulator
//! that a diagnosis fits.

mod actuation;
mod foreign;
mod friction;
mod mechanics;
mod own;
mod sensing;
mod surroundings;

pub(crate) use actuation::{Actuator, Cogging, Deadband, InputCurve, InputSeries, InputShape};
pub(crate) use foreign::{Creep, Disturbance, Foreign, Window};
pub(crate) use friction::{Bristle, Friction, Profile, WarmUp};
pub(crate) use mechanics::{Coupling, Mechanics, Side, Stop};
pub(crate) use own::OwnTorque;
pub(crate) use sensing::{Curve, Jump, Play, Sensing, Slip};
pub(crate) use surroundings::{Contact, Push};

use recording::Model;

/// Speeds below this count as zero, in units per second. It is far below the velocity resolution of any sensor.
const REST: f64 = 1e-12;

/// A device. By default each law has no effect.
#[derive(Clone, Debug)]
pub(crate) struct Reality {
    pub actuator: Actuator,
    pub friction: Friction,
    pub mechanics: Mechanics,
    pub sensing: Sensing,
    pub contact: Option<Contact>,
    pub pushes: Vec<Push>,
    pub foreign: Foreign,
    pub own: Option<OwnTorque>,
}

/// Position and velocity of one inertia.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    pub x: f64,
    pub v: f64,
}

/// A first-order lag advanced from `from` by `dt` under a constant target. With `lag_s` = 0 it is the target.
fn relaxed(from: f64, target: f64, lag_s: f64, dt: f64) -> f64 {
    if lag_s > 0.0 {
        target + (from - target) * (-dt / lag_s).exp()
    } else {
        target
    }
}

/// All states of a device. `load` is the whole device if its transmission is rigid.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// Time of the session, s.
    pub time_s: f64,
    pub load: Motion,
    pub motor: Motion,
    pub actuator: actuation::Memory,
    pub friction: friction::Memory,
    pub sensing: sensing::Memory,
    pub foreign: foreign::Memory,
}

impl Reality {
    /// The device that `model` describes, with nothing hidden.
    pub fn plain(model: &Model) -> Self {
        Self {
            actuator: Actuator::plain(model),
            friction: Friction::plain(model),
            mechanics: Mechanics::plain(model),
            sensing: Sensing::default(),
            contact: None,
            pushes: Vec::new(),
            foreign: Foreign::default(),
            own: None,
        }
    }

    /// The device at rest at position `x` and time `time_s` of the session. No input has acted so far.
    pub fn at_rest(&self, x: f64, time_s: f64) -> State {
        let motion = Motion { x, v: 0.0 };
        State {
            time_s,
            load: motion,
            motor: motion,
            actuator: actuation::Memory::default(),
            friction: friction::Memory::default(),
            sensing: self.sensing.settled(x),
            foreign: foreign::Memory::default(),
        }
    }

    /// The motion that the sensor measures.
    pub fn sensed<'a>(&self, state: &'a State) -> &'a Motion {
        match self.mechanics.coupling {
            Some(Coupling {
                sensor: Side::Motor,
                ..
            }) => &state.motor,
            _ => &state.load,
        }
    }

    /// The reading of the position sensor in `run`, before noise and quantisation.
    pub fn reading(&self, state: &State, run: usize) -> f64 {
        self.sensing
            .reading(&state.sensing, self.sensed(state).x, run, state.time_s)
    }

    /// The time derivative of the reading.
    pub fn reading_rate(&self, state: &State) -> f64 {
        let sensed = self.sensed(state);
        self.sensing
            .rate(&state.sensing, sensed.x, sensed.v, state.time_s)
    }

    /// Shifts position and velocity by `dx` and `dv` of the reading. The hidden states keep their values relative to them.
    pub fn displace(&self, state: &mut State, dx: f64, dv: f64) {
        let slope = self.sensing.slope(self.sensed(state).x);
        for motion in [&mut state.load, &mut state.motor] {
            motion.x += dx / slope;
            motion.v += dv / slope;
        }
        self.sensing.displace(&mut state.sensing, dx);
    }

    /// Advances `state` to `until_s` of the session, in equal steps of at most `step_s`.
    pub fn advance(
        &self,
        state: &mut State,
        input: &InputSeries,
        run: usize,
        until_s: f64,
        step_s: f64,
    ) {
        let span_s = until_s - state.time_s;
        if span_s <= 0.0 {
            return;
        }
        let steps = (span_s / step_s).ceil().max(1.0);
        let dt = span_s / steps;
        for _ in 0..steps as usize {
            self.step(state, input, run, dt);
        }
        state.time_s = until_s;
    }

    fn step(&self, state: &mut State, input: &InputSeries, run: usize, dt: f64) {
        let time_s = state.time_s + 0.5 * dt;
        let coupling = self.mechanics.coupling.as_ref();
        let load = Motion {
            x: state.load.x + 0.5 * dt * state.load.v,
            v: state.load.v,
        };
        let motor = Motion {
            x: state.motor.x + 0.5 * dt * state.motor.v,
            v: state.motor.v,
        };

        let driven = if coupling.is_some() { motor } else { load };
        let drive = self.foreign.fade(&mut state.foreign, time_s, dt)
            * self
                .actuator
                .torque(&mut state.actuator, input, time_s, driven, dt)
            + self.foreign.torque(&mut state.foreign, time_s, load, dt);
        let mut on_load = self.mechanics.torque(load, self.foreign.tilt(time_s));
        let carried = if self.friction.carries_all {
            drive + on_load
        } else {
            drive
        };
        if let Some(contact) = &self.contact {
            on_load += contact.torque(load, run, time_s);
        }
        if let Some(own) = &self.own {
            on_load += own.torque(load, drive / self.actuator.ratio, time_s);
        }
        let pushes = self.pushes.iter().map(|push| push.torque(run, time_s));
        on_load += pushes.sum::<f64>();
        let level = self.friction.level(load, carried, time_s);
        let inertia = self.mechanics.inertia * self.foreign.inertia_factor(time_s);

        match coupling {
            None => {
                let free = drive + on_load;
                let resisted = self.friction.resist(
                    &mut state.friction,
                    free,
                    load.v,
                    inertia,
                    level,
                    1.0,
                    dt,
                );
                state.load = moved(state.load, resisted, dt);
            }
            Some(coupling) => {
                let through = coupling.torque(motor, load);
                let (motor_j, load_j) = (
                    inertia * coupling.motor_share,
                    inertia * (1.0 - coupling.motor_share),
                );
                let motor_friction = coupling.motor_friction;
                let v = Friction::project(
                    &self.friction,
                    drive - through,
                    motor.v,
                    motor_j,
                    level,
                    motor_friction,
                    dt,
                );
                state.motor = moved(state.motor, v, dt);
                let v = self.friction.resist(
                    &mut state.friction,
                    on_load + through,
                    load.v,
                    load_j,
                    level,
                    1.0 - motor_friction,
                    dt,
                );
                state.load = moved(state.load, v, dt);
            }
        }
        state.time_s += dt;
        let sensed = self.sensed(state).x;
        self.sensing.remember(&mut state.sensing, sensed, dt);
    }
}

/// Midpoint rule: the position advances by the mean of the old and new velocities.
fn moved(from: Motion, v: f64, dt: f64) -> Motion {
    Motion {
        x: from.x + 0.5 * dt * (from.v + v),
        v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pendulum(coulomb: f64) -> Model {
        Model {
            gravity: 0.015,
            coulomb,
            viscous: 2e-4,
            ..Model::new(5e-4)
        }
    }

    /// Position at `until_s` under a sine torque that reverses the motion several times.
    fn driven(model: &Model, torque: f64, until_s: f64, step_s: f64) -> f64 {
        let reality = Reality::plain(model);
        let times: Vec<f64> = (0..)
            .map(|k| f64::from(k) * 1e-3)
            .take_while(|t| *t < until_s)
            .collect();
        let values = times.iter().map(|t| torque * (6.0 * t).sin()).collect();
        let input = InputSeries::new(times, values);
        let mut state = reality.at_rest(0.0, 0.0);
        reality.advance(&mut state, &input, 0, until_s, step_s);
        reality.reading(&state, 0)
    }

    #[test]
    fn the_usual_step_and_a_finer_one_agree_within_the_resolution_of_a_sensor() {
        let model = pendulum(0.008);
        let usual = driven(&model, 0.014, 4.0, 20e-6);
        let finer = driven(&model, 0.014, 4.0, 1e-6);
        assert!(usual.abs() > 0.05, "it moves: {usual}");
        assert!((usual - finer).abs() < 2e-5, "{usual} {finer}");
    }

    #[test]
    fn a_torque_below_the_coulomb_friction_moves_nothing() {
        assert_eq!(driven(&pendulum(0.03), 0.029, 2.0, 20e-6), 0.0);
        assert!(driven(&pendulum(0.03), 0.035, 0.3, 20e-6) > 0.0);
    }

    #[test]
    fn two_stiffly_coupled_inertias_move_as_one() {
        let model = pendulum(0.0);
        let mut split = Reality::plain(&model);
        split.mechanics.coupling = Some(Coupling {
            half_gap: 0.0,
            stiffness: 500.0,
            damping: 0.05,
            motor_share: 0.4,
            motor_friction: 0.5,
            sensor: Side::Load,
        });
        let input = InputSeries::new(vec![0.0], vec![0.01]);
        let mut state = split.at_rest(0.0, 0.0);
        split.advance(&mut state, &input, 0, 0.5, 5e-6);
        let one = Reality::plain(&model);
        let mut whole = one.at_rest(0.0, 0.0);
        one.advance(&mut whole, &input, 0, 0.5, 5e-6);
        let difference = (split.reading(&state, 0) - one.reading(&whole, 0)).abs();
        assert!(difference < 1e-4 && whole.load.x > 0.1, "{difference}");
    }
}
