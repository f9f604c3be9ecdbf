//! From the true position to the clean reading: gain and curve, play, lag, lost counts, low-pass.

use super::relaxed;
use std::f64::consts::TAU;

/// Share of the play within which it counts as taken up: rounding, no more.
const PLAY_TAKEN_UP: f64 = 1e-6;

/// A departure from the straight line, in units of position.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Curve {
    /// `amount * (x - at)^2 / scale`
    Quadratic { amount: f64, at: f64, scale: f64 },
    /// `amount * (x - at)^3 / scale^2`
    Cubic { amount: f64, at: f64, scale: f64 },
    /// `amount * scale * sin((x - at) / scale)`
    Wave { amount: f64, at: f64, scale: f64 },
}

impl Curve {
    fn departure(self, x: f64) -> f64 {
        match self {
            Self::Quadratic { amount, at, scale } => amount * (x - at).powi(2) / scale,
            Self::Cubic { amount, at, scale } => amount * (x - at).powi(3) / (scale * scale),
            Self::Wave { amount, at, scale } => amount * scale * ((x - at) / scale).sin(),
        }
    }

    fn slope(self, x: f64) -> f64 {
        match self {
            Self::Quadratic { amount, at, scale } => 2.0 * amount * (x - at) / scale,
            Self::Cubic { amount, at, scale } => 3.0 * amount * ((x - at) / scale).powi(2),
            Self::Wave { amount, at, scale } => amount * ((x - at) / scale).cos(),
        }
    }
}

/// Counts lost in `run` from `since_s` of the session on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub run: usize,
    pub since_s: f64,
    pub by: f64,
}

/// A counter that falls behind where its input turns too fast.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slip {
    /// Speed up to which it counts all.
    pub above: f64,
    /// Share of the turn beyond that it misses.
    pub share: f64,
}

impl Slip {
    /// Missed of a turn by `dx` within `dt`.
    fn missed(self, dx: f64, dt: f64) -> f64 {
        let counted = self.above * dt;
        self.share * dx.signum() * (dx.abs() - counted).max(0.0)
    }
}

/// A sensor of the position; the default is perfect.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sensing {
    /// Departure of the gain from 1.
    pub gain_error: f64,
    pub curve: Option<Curve>,
    /// Half the width of the play between position and reading.
    pub half_play: f64,
    pub lag_s: f64,
    /// Of another lag behind that one.
    pub further_lag_s: f64,
    pub jumps: Vec<Jump>,
    pub slip: Option<Slip>,
    /// Disturbance of the reading in time: amplitude and frequency. Outside the vocabulary.
    pub hum: Option<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    played: f64,
    lagged: f64,
    further: f64,
    missed: f64,
    before: f64,
}

impl Sensing {
    /// The memory after a long rest at `x`.
    pub fn settled(&self, x: f64) -> Memory {
        let shaped = self.shaped(x);
        Memory {
            played: shaped,
            lagged: shaped,
            further: shaped,
            missed: 0.0,
            before: shaped,
        }
    }

    /// Takes note of the position after a step of `dt`.
    pub fn remember(&self, memory: &mut Memory, x: f64, dt: f64) {
        if let Some(slip) = self.slip {
            let shaped = self.shaped(x);
            memory.missed += slip.missed(shaped - memory.before, dt);
            memory.before = shaped;
        }
        if self.half_play > 0.0 || self.lag_s > 0.0 {
            let shaped = self.shaped(x);
            memory.played = memory
                .played
                .clamp(shaped - self.half_play, shaped + self.half_play);
            memory.lagged = relaxed(memory.lagged, memory.played, self.lag_s, dt);
            memory.further = relaxed(memory.further, memory.lagged, self.further_lag_s, dt);
        }
    }

    /// The clean reading at `x`.
    pub fn reading(&self, memory: &Memory, x: f64, run: usize, time_s: f64) -> f64 {
        let base = if self.half_play > 0.0 || self.lag_s > 0.0 {
            memory.further
        } else {
            self.shaped(x)
        };
        let lost: f64 = self
            .jumps
            .iter()
            .filter(|jump| jump.run == run && time_s >= jump.since_s)
            .map(|jump| jump.by)
            .sum();
        let hum = self
            .hum
            .map_or(0.0, |(amplitude, hz)| amplitude * (TAU * hz * time_s).sin());
        base + lost - memory.missed + hum
    }

    /// How fast the clean reading changes at position `x` and velocity `v`.
    pub fn rate(&self, memory: &Memory, x: f64, v: f64, time_s: f64) -> f64 {
        let shaped = self.shaped(x);
        let carried = (shaped - memory.played) * v > 0.0
            && (shaped - memory.played).abs() >= self.half_play * (1.0 - PLAY_TAKEN_UP);
        let base = if self.further_lag_s > 0.0 {
            (memory.lagged - memory.further) / self.further_lag_s
        } else if self.lag_s > 0.0 {
            (memory.played - memory.lagged) / self.lag_s
        } else if self.half_play > 0.0 && !carried {
            0.0
        } else {
            self.slope(x) * v
        };
        let hum = self.hum.map_or(0.0, |(amplitude, hz)| {
            amplitude * TAU * hz * (TAU * hz * time_s).cos()
        });
        let missed = self.slip.map_or(0.0, |slip| slip.missed(base, 1.0));
        base - missed + hum
    }

    /// Reading per unit of position around `x`.
    pub fn slope(&self, x: f64) -> f64 {
        1.0 + self.gain_error + self.curve.map_or(0.0, |curve| curve.slope(x))
    }

    /// Shifts the memory by `dx` of reading.
    pub fn displace(&self, memory: &mut Memory, dx: f64) {
        memory.played += dx;
        memory.lagged += dx;
        memory.further += dx;
        memory.before += dx;
    }

    fn shaped(&self, x: f64) -> f64 {
        (1.0 + self.gain_error) * x + self.curve.map_or(0.0, |curve| curve.departure(x))
    }
}
