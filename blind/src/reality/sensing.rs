//! The position sensor, from the true position to the reading before noise: gain, nonlinearity, hysteresis, lag, lost counts
//! and low-pass.

use super::relaxed;
use std::f64::consts::TAU;

/// Relative rounding error within which a hysteresis element counts as fully deflected.
const PLAY_TAKEN_UP: f64 = 1e-6;
/// Widths of the parallel elements of a soft hysteresis, relative to its own width.
const PLAYS: [f64; 4] = [0.25, 0.75, 1.25, 1.75];

/// A deviation from the linear characteristic, in units of position.
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

/// A counter that misses part of the motion above a speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slip {
    /// Largest speed at which no count is lost.
    pub above: f64,
    /// Share of the motion above that speed which is lost.
    pub share: f64,
}

impl Slip {
    /// The lost part of a motion by `dx` within `dt`.
    fn missed(self, dx: f64, dt: f64) -> f64 {
        let counted = self.above * dt;
        self.share * dx.signum() * (dx.abs() - counted).max(0.0)
    }
}

/// Sensor hysteresis: on reversal the reading stays until the position has moved by the width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Play {
    /// Half the width, in units of position.
    pub half_width: f64,
    /// `None` for a single play element. Otherwise a sum of parallel play elements (Prandtl-Ishlinskii): this value scales
    /// their widths and divides their shares of the reading.
    pub softness: Option<f64>,
}

impl Play {
    /// Half width of each play element and its share of the reading.
    fn parts(self) -> [[f64; 2]; PLAYS.len()] {
        match self.softness {
            None => core::array::from_fn(|i| [self.half_width, if i == 0 { 1.0 } else { 0.0 }]),
            Some(wider) => PLAYS.map(|width| {
                let share = 1.0 / (wider * PLAYS.len() as f64);
                [self.half_width * wider * width, share]
            }),
        }
    }
}

/// A position sensor. The default is ideal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sensing {
    /// Relative gain error.
    pub gain_error: f64,
    /// Position at which the gain error causes no error of the reading.
    pub right_at: f64,
    pub curve: Option<Curve>,
    pub play: Option<Play>,
    pub lag_s: f64,
    /// Time constant of a second lag in series, s.
    pub further_lag_s: f64,
    pub jumps: Vec<Jump>,
    pub slip: Option<Slip>,
    /// Sinusoidal disturbance of the reading: amplitude and frequency. It is outside the vocabulary.
    pub hum: Option<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    /// Deflection of each play element.
    behind: [f64; PLAYS.len()],
    /// The position after gain and nonlinearity.
    shaped: f64,
    played: f64,
    lagged: f64,
    further: f64,
    missed: f64,
}

impl Sensing {
    /// The states after a long rest at `x`.
    pub fn settled(&self, x: f64) -> Memory {
        let shaped = self.shaped(x);
        Memory {
            behind: [0.0; PLAYS.len()],
            shaped,
            played: shaped,
            lagged: shaped,
            further: shaped,
            missed: 0.0,
        }
    }

    /// Updates the states after a step of `dt` that ends at `x`.
    pub fn remember(&self, memory: &mut Memory, x: f64, dt: f64) {
        let shaped = self.shaped(x);
        let step = shaped - memory.shaped;
        memory.shaped = shaped;
        if let Some(slip) = self.slip {
            memory.missed += slip.missed(step, dt);
        }
        if self.play.is_some() || self.lag_s > 0.0 {
            memory.played = shaped;
            for (behind, [half_width, share]) in memory.behind.iter_mut().zip(self.plays()) {
                *behind = (*behind + step).clamp(-half_width, half_width);
                memory.played -= share * *behind;
            }
            memory.lagged = relaxed(memory.lagged, memory.played, self.lag_s, dt);
            memory.further = relaxed(memory.further, memory.lagged, self.further_lag_s, dt);
        }
    }

    /// The reading at `x`, before noise and quantisation.
    pub fn reading(&self, memory: &Memory, x: f64, run: usize, time_s: f64) -> f64 {
        let base = if self.play.is_some() || self.lag_s > 0.0 {
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

    /// Time derivative of the reading at position `x` and velocity `v`.
    pub fn rate(&self, memory: &Memory, x: f64, v: f64, time_s: f64) -> f64 {
        let base = if self.further_lag_s > 0.0 {
            (memory.lagged - memory.further) / self.further_lag_s
        } else if self.lag_s > 0.0 {
            (memory.played - memory.lagged) / self.lag_s
        } else {
            self.carried(memory, v) * self.slope(x) * v
        };
        let hum = self.hum.map_or(0.0, |(amplitude, hz)| {
            amplitude * TAU * hz * (TAU * hz * time_s).cos()
        });
        let missed = self.slip.map_or(0.0, |slip| slip.missed(base, 1.0));
        base - missed + hum
    }

    fn plays(&self) -> impl Iterator<Item = [f64; 2]> {
        self.play.into_iter().flat_map(Play::parts)
    }

    /// Share of the reading that follows the position at velocity `v`: that of the fully deflected play elements.
    fn carried(&self, memory: &Memory, v: f64) -> f64 {
        let slack = memory.behind.iter().zip(self.plays());
        let slack = slack.filter(|(behind, [half_width, _])| {
            *behind * v.signum() < half_width * (1.0 - PLAY_TAKEN_UP)
        });
        1.0 - slack.map(|(_, [_, share])| share).sum::<f64>()
    }

    /// Slope of the static characteristic at `x`.
    pub fn slope(&self, x: f64) -> f64 {
        1.0 + self.gain_error + self.curve.map_or(0.0, |curve| curve.slope(x))
    }

    /// Shifts the states by `dx` of the reading.
    pub fn displace(&self, memory: &mut Memory, dx: f64) {
        memory.shaped += dx;
        memory.played += dx;
        memory.lagged += dx;
        memory.further += dx;
    }

    fn shaped(&self, x: f64) -> f64 {
        x + self.gain_error * (x - self.right_at)
            + self.curve.map_or(0.0, |curve| curve.departure(x))
    }
}
