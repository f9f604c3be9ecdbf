//! The actuator: from the input to the torque at the joint.

use super::{Motion, relaxed};
use recording::Model;

/// The commanded input as a step function: each value holds until the next entry.
#[derive(Clone, Debug, Default)]
pub(crate) struct InputSeries {
    since_s: Vec<f64>,
    value: Vec<f64>,
}

impl InputSeries {
    pub fn new(since_s: Vec<f64>, value: Vec<f64>) -> Self {
        Self { since_s, value }
    }

    /// Sets the input to `value` from `since_s` on. Entries must come in the order of time.
    pub fn push(&mut self, since_s: f64, value: f64) {
        self.since_s.push(since_s);
        self.value.push(value);
    }

    /// The input at `time_s`. Before the first entry it has the first value. Without entries it is 0.
    pub fn value_at(&self, time_s: f64) -> f64 {
        let next = self.since_s.partition_point(|since| *since <= time_s);
        let value = self.value.get(next.saturating_sub(1));
        value.copied().unwrap_or(0.0)
    }

    /// The mean input from `from_s` to `to_s`. `to_s` must be later.
    pub fn mean(&self, from_s: f64, to_s: f64) -> f64 {
        let first = self.since_s.partition_point(|since| *since <= from_s);
        let last = self.since_s.partition_point(|since| *since < to_s);
        let changes = self.since_s[first.min(last)..last].iter().copied();
        let (mut at_s, mut impulse) = (from_s, 0.0);
        for change_s in changes.chain([to_s]) {
            impulse += self.value_at(at_s) * (change_s - at_s);
            at_s = change_s;
        }
        impulse / (to_s - from_s)
    }

    /// The input at `time_s`, 0 before the first entry. `cursor` keeps the index between calls.
    fn at(&self, time_s: f64, cursor: &mut usize) -> f64 {
        if *cursor > self.since_s.len() || (*cursor > 0 && self.since_s[*cursor - 1] > time_s) {
            *cursor = self.since_s.partition_point(|since| *since <= time_s);
        }
        while *cursor < self.since_s.len() && self.since_s[*cursor] <= time_s {
            *cursor += 1;
        }
        if *cursor == 0 {
            0.0
        } else {
            self.value[*cursor - 1]
        }
    }
}

/// Dead bands. `Subtracted` reduces the magnitude by the width, separately on each side. `Gated` passes only inputs larger
/// than the width, without reduction.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Deadband {
    Subtracted { below: f64, above: f64 },
    Gated(f64),
}

/// A nonlinear input characteristic. It leaves an input of the reference magnitude unchanged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputCurve {
    /// Magnitude of the input that stays unchanged.
    pub reference: f64,
    pub shape: InputShape,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum InputShape {
    /// `U (u / U)^p` for the reference `U`.
    Power(f64),
    /// Slope `1 + k` up to half the reference, and `1 - k` above it.
    Bent(f64),
}

impl InputCurve {
    fn of(self, u: f64) -> f64 {
        let part = u.abs() / self.reference;
        let acts = match self.shape {
            InputShape::Power(power) => part.powf(power),
            InputShape::Bent(k) => (1.0 + k) * part.min(0.5) + (1.0 - k) * (part - 0.5).max(0.0),
        };
        (self.reference * acts).copysign(u)
    }
}

/// Torque as a function of position: `first sin(k x + phase) + second sin(2 k x + 2 phase)` plus two waves of other orders,
/// N m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cogging {
    pub first: f64,
    pub second: f64,
    /// Wave number `k` of the first wave, rad per unit of position.
    pub wave_number: f64,
    pub phase_rad: f64,
    /// The two waves of other orders: amplitude in N m, and order, that is, wave number over `k`.
    pub further: [(f64, f64); 2],
}

#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    /// Joint torque per unit of input.
    pub ratio: f64,
    /// Largest magnitude of the input that acts. Infinite if there is no limit.
    pub limit: f64,
    /// Speed at which the limit falls to zero, if the input acts along the motion. Infinite if the limit is constant.
    pub no_load: f64,
    /// Width over which the limit is rounded, relative to the limit.
    pub knee: f64,
    pub deadband: Option<Deadband>,
    pub curve: Option<InputCurve>,
    pub delay_s: f64,
    pub lag_s: f64,
    /// Time constant of a second lag in series, s.
    pub further_lag_s: f64,
    /// Constant torque, N m.
    pub offset: f64,
    pub cogging: Option<Cogging>,
    /// Largest rate of the acting input, per second. Infinite if there is no limit.
    pub slew: f64,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    cursor: usize,
    slewed: f64,
    lagged: f64,
    further: f64,
}

impl Actuator {
    pub fn plain(model: &Model) -> Self {
        Self {
            ratio: model.ratio,
            limit: model.input_limit.unwrap_or(f64::INFINITY),
            no_load: f64::INFINITY,
            knee: 0.0,
            deadband: None,
            curve: None,
            delay_s: model.delay,
            lag_s: model.lag,
            further_lag_s: 0.0,
            offset: model.offset,
            cogging: None,
            slew: f64::INFINITY,
        }
    }

    /// Torque in the middle of a step of `dt`, at `time_s` of the session, during `motion`.
    pub fn torque(
        &self,
        memory: &mut Memory,
        input: &InputSeries,
        time_s: f64,
        motion: Motion,
        dt: f64,
    ) -> f64 {
        let commanded = input.at(time_s - self.delay_s, &mut memory.cursor);
        let mut u = self.limited(commanded, motion.v);
        u = match self.deadband {
            None => u,
            Some(Deadband::Subtracted { below, above }) => u - u.clamp(-below, above),
            Some(Deadband::Gated(width)) => {
                if u.abs() < width {
                    0.0
                } else {
                    u
                }
            }
        };
        u = self.curve.map_or(u, |curve| curve.of(u));
        let reach = self.slew * dt;
        memory.slewed += (u - memory.slewed).clamp(-reach, reach);
        let u = behind(&mut memory.lagged, memory.slewed, self.lag_s, dt);
        let u = behind(&mut memory.further, u, self.further_lag_s, dt);
        let ripple = self.cogging.map_or(0.0, |c| {
            let angle = c.wave_number * motion.x + c.phase_rad;
            let further = c.further.map(|(nm, order)| nm * (order * angle).sin());
            c.first * angle.sin() + c.second * (2.0 * angle).sin() + further.iter().sum::<f64>()
        });
        self.ratio * u + self.offset + ripple
    }

    fn limited(&self, u: f64, v: f64) -> f64 {
        if self.no_load.is_finite() {
            let most = |along: f64| self.limit * (1.0 - along / self.no_load).max(0.0);
            return u.clamp(-most(-v), most(v));
        }
        if self.knee == 0.0 {
            return u.clamp(-self.limit, self.limit);
        }
        // Above (1 - knee) of the limit, the input approaches the limit smoothly.
        let linear = self.limit * (1.0 - self.knee);
        if u.abs() <= linear {
            return u;
        }
        let room = self.limit - linear;
        u.signum() * (linear + room * ((u.abs() - linear) / room).tanh())
    }
}

/// Advances a first-order lag towards `target` by `dt`. Returns its value in the middle of the step.
fn behind(lagged: &mut f64, target: f64, lag_s: f64, dt: f64) -> f64 {
    let before = *lagged;
    *lagged = relaxed(before, target, lag_s, dt);
    if lag_s > 0.0 {
        0.5 * (before + *lagged)
    } else {
        target
    }
}
