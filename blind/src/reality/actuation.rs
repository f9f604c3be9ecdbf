//! From the input to the torque at the joint.

use super::{Motion, relaxed};
use recording::Model;

/// What was commanded, held until the next entry.
#[derive(Clone, Debug, Default)]
pub(crate) struct InputSeries {
    since_s: Vec<f64>,
    value: Vec<f64>,
}

impl InputSeries {
    pub fn new(since_s: Vec<f64>, value: Vec<f64>) -> Self {
        Self { since_s, value }
    }

    /// Commands `value` from `since_s` on; entries come in the order of time.
    pub fn push(&mut self, since_s: f64, value: f64) {
        self.since_s.push(since_s);
        self.value.push(value);
    }

    /// What is commanded at `time_s`, the first entry also before it; 0 without entries.
    pub fn value_at(&self, time_s: f64) -> f64 {
        let next = self.since_s.partition_point(|since| *since <= time_s);
        let value = self.value.get(next.saturating_sub(1));
        value.copied().unwrap_or(0.0)
    }

    /// The mean between two instants, the second of which is later.
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

    /// What is commanded at `time_s`; 0 before the first entry. `cursor` remembers the place between calls.
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

/// The usual dead bands: what is left starts at zero, on either side from where that is, or at the edge with a jump.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Deadband {
    Subtracted { below: f64, above: f64 },
    Gated(f64),
}

/// What acts of an input is a curve of it, with nothing changed at the reference input.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputCurve {
    /// Magnitude at which nothing is changed.
    pub reference: f64,
    pub shape: InputShape,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum InputShape {
    /// `U (u / U)^p`.
    Power(f64),
    /// Slope `1 + k` up to half of the reference, and `1 - k` beyond.
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

/// Torque over position: `first sin(k x + phase) + second sin(2 k x + 2 phase)` and waves of further orders, N m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cogging {
    pub first: f64,
    pub second: f64,
    /// rad per unit of position.
    pub wave_number: f64,
    pub phase_rad: f64,
    /// Waves of other orders: torque, N m, and wave number over the first one's.
    pub further: [(f64, f64); 2],
}

#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    /// Joint torque per unit of input.
    pub ratio: f64,
    /// Beyond this the input does not act; infinite for none.
    pub limit: f64,
    /// Speed the way of the input at which the limit has fallen to nothing; infinite for none.
    pub no_load: f64,
    /// Width over which the limit rounds off, relative to it.
    pub knee: f64,
    pub deadband: Option<Deadband>,
    pub curve: Option<InputCurve>,
    pub delay_s: f64,
    pub lag_s: f64,
    /// Of another lag behind that one.
    pub further_lag_s: f64,
    /// Constant torque, N m.
    pub offset: f64,
    pub cogging: Option<Cogging>,
    /// Fastest change of what acts of the input, per second; infinite for none.
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

    /// Torque in the middle of a step of `dt`, at the session's `time_s` and in a `motion`.
    pub fn torque(
        &self,
        memory: &mut Memory,
        input: &InputSeries,
        time_s: f64,
        motion: Motion,
        dt: f64,
    ) -> f64 {
        let told = input.at(time_s - self.delay_s, &mut memory.cursor);
        let mut u = self.limited(told, motion.v);
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
        // Smooth towards the limit from (1 - knee) of it on.
        let linear = self.limit * (1.0 - self.knee);
        if u.abs() <= linear {
            return u;
        }
        let room = self.limit - linear;
        u.signum() * (linear + room * ((u.abs() - linear) / room).tanh())
    }
}

/// What a lag makes of a target over a step of `dt`, in the middle of it.
fn behind(lagged: &mut f64, target: f64, lag_s: f64, dt: f64) -> f64 {
    let before = *lagged;
    *lagged = relaxed(before, target, lag_s, dt);
    if lag_s > 0.0 {
        0.5 * (before + *lagged)
    } else {
        target
    }
}
