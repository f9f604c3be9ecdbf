//! From the position to its reading, before noise and quantisation.

use crate::hysteresis::Hysteresis;
use crate::ripple::Ripple;

/// A permanent jump of the reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Time of the jump in the session, s.
    pub at_s: f64,
    /// Height of the jump, in units of position.
    pub height: f64,
}

/// A counter that loses counts above a speed: `y' = x' − q (x' − v sgn x')` where `|x'| > v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overspeed {
    /// Share q of the excess rate that is lost, 0 to 1.
    pub share: f64,
    /// Largest rate v without loss, in units of position per second.
    pub speed: f64,
}

impl Overspeed {
    /// A counter that loses nothing.
    pub const NONE: Self = Self {
        share: 0.0,
        speed: 0.0,
    };

    /// True if it loses nothing.
    pub fn is_none(&self) -> bool {
        self.share == 0.0
    }

    /// Lost rate at the true rate `rate`.
    #[inline]
    pub fn lost(&self, rate: f64) -> f64 {
        self.share * (rate - rate.clamp(-self.speed, self.speed))
    }

    /// True rate for the shown rate. If the whole excess is lost (q = 1), the lowest possible rate.
    #[inline]
    pub fn undone(&self, shown: f64) -> f64 {
        let too_fast = shown - shown.clamp(-self.speed, self.speed);
        if self.share < 1.0 {
            shown + too_fast * self.share / (1.0 - self.share)
        } else {
            shown - too_fast
        }
    }
}

/// `y = jumps(t) − lost(x) + lag(hysteresis(g x + a x² + b x³ + r sin(n x) + s (cos(n x) − 1) + o))`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensing {
    /// Gain g: shown over true motion.
    pub gain: f64,
    /// Second-order coefficient a, 1/position.
    pub quadratic: f64,
    /// Third-order coefficient b, 1/position².
    pub cubic: f64,
    /// Ripple with the amplitudes r and s, in units of position, and the wave number n, 1/position.
    pub ripple: Ripple,
    /// Offset o, in units of position.
    pub offset: f64,
    /// Hysteresis after the nonlinearity.
    pub hysteresis: Hysteresis,
    /// Time constant of the lag, s.
    pub lag_s: f64,
    /// Time constant of a second lag in series, s.
    pub further_lag_s: f64,
    /// Jumps in the order of time.
    pub jumps: Vec<Jump>,
    /// Loss of counts above a speed. It acts before the lag.
    pub overspeed: Overspeed,
}

impl Sensing {
    /// An ideal sensor, which reads the true position.
    pub fn ideal() -> Self {
        Self {
            gain: 1.0,
            quadratic: 0.0,
            cubic: 0.0,
            ripple: Ripple::NONE,
            offset: 0.0,
            hysteresis: Hysteresis::NONE,
            lag_s: 0.0,
            further_lag_s: 0.0,
            jumps: Vec::new(),
            overspeed: Overspeed::NONE,
        }
    }

    /// True if the sensor is ideal.
    pub fn is_ideal(&self) -> bool {
        *self == Self::ideal()
    }

    /// Reading at rest at a position, without jumps.
    #[inline]
    pub fn curve(&self, x: f64) -> f64 {
        let smooth = self.offset + x * (self.gain + x * (self.quadratic + x * self.cubic));
        if self.ripple.is_none() {
            return smooth;
        }
        smooth + self.ripple.at(x)
    }

    /// Slope of the nonlinearity at a position.
    #[inline]
    pub fn slope(&self, x: f64) -> f64 {
        let smooth = self.gain + x * (2.0 * self.quadratic + x * 3.0 * self.cubic);
        if self.ripple.is_none() {
            return smooth;
        }
        smooth + self.ripple.slope(x)
    }

    /// The position with the reading `y`, by Newton's method from the linear part. It converges if the nonlinearity is
    /// monotonic between the two.
    pub fn inverse(&self, y: f64) -> f64 {
        let mut x = (y - self.offset) / self.gain;
        if self.quadratic == 0.0 && self.cubic == 0.0 && self.ripple.is_none() {
            return x;
        }
        for _ in 0..INVERSE_ITERATIONS {
            let slope = self.slope(x);
            let flattest = self.flattest();
            x -= (self.curve(x) - y)
                / if slope.abs() < flattest {
                    flattest
                } else {
                    slope
                };
        }
        x
    }

    /// True if the slope is too small to determine the position from a reading.
    pub fn is_flat(&self, x: f64) -> bool {
        self.slope(x).abs() < self.flattest()
    }

    /// Slope below which the characteristic counts as flat.
    fn flattest(&self) -> f64 {
        FLATTEST * self.gain.abs()
    }

    /// Sum of the jumps up to `time_s`.
    #[inline]
    pub fn jumped(&self, time_s: f64) -> f64 {
        self.jumps
            .iter()
            .filter(|jump| jump.at_s <= time_s)
            .map(|jump| jump.height)
            .sum()
    }

    /// Mean of the jumps over `span_s` around `time_s`.
    #[inline]
    pub fn jumped_mean(&self, time_s: f64, span_s: f64) -> f64 {
        if span_s == 0.0 {
            return self.jumped(time_s);
        }
        let share = |jump: &Jump| ((time_s - jump.at_s) / span_s + 0.5).clamp(0.0, 1.0);
        self.jumps.iter().map(|j| share(j) * j.height).sum()
    }
}

const INVERSE_ITERATIONS: usize = 6;
/// Slope that counts as flat, as a share of the gain.
const FLATTEST: f64 = 0.1;

/// State of a sensor: hysteresis, lags and lost counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Position after nonlinearity and hysteresis.
    pub followed: f64,
    /// Deviation of the hysteresis.
    pub behind: f64,
    /// Reading after the first lag.
    pub between: f64,
    /// Reading after both lags.
    pub lagged: f64,
    /// Counts lost above the speed limit, in units of position.
    pub lost: f64,
}

impl Reading {
    /// The state at rest at the position `x`.
    pub fn at_rest(sensing: &Sensing, x: f64) -> Self {
        let y = sensing.curve(x);
        Self {
            followed: y,
            behind: 0.0,
            between: y,
            lagged: y,
            lost: 0.0,
        }
    }

    /// Moves to the position `x`, `dt_s` after the last call. Returns the reading without jumps.
    #[inline]
    pub fn follow(&mut self, sensing: &Sensing, x: f64, dt_s: f64) -> f64 {
        let curve = sensing.curve(x);
        let before = self.followed;
        let step = curve - (before + self.behind);
        self.behind = sensing.hysteresis.after(self.behind, step);
        let y = curve - self.behind;
        self.followed = y;
        let step = y - before;
        let slope = || if dt_s > 0.0 { step / dt_s } else { 0.0 };
        if !sensing.overspeed.is_none() {
            self.lost += sensing.overspeed.lost(slope()) * dt_s;
        }
        let between = lagging(self.between, [before, y], dt_s, sensing.lag_s);
        let through = [self.between, between];
        self.lagged = lagging(self.lagged, through, dt_s, sensing.further_lag_s);
        self.between = between;
        self.lagged - self.lost
    }
}

/// Output of a lag with the initial value `lagged`, for an input that changes linearly.
#[inline]
fn lagging(lagged: f64, [before, after]: [f64; 2], dt_s: f64, lag_s: f64) -> f64 {
    if lag_s == 0.0 {
        return after;
    }
    if dt_s <= 0.0 {
        return lagged;
    }
    let behind = (after - before) / dt_s * lag_s;
    let decay = (-dt_s / lag_s).exp();
    after - behind + (lagged - before + behind) * decay
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_gives_the_position_back() {
        let sensing = Sensing {
            gain: 1.1,
            quadratic: 0.2,
            cubic: -0.3,
            ..Sensing::ideal()
        };
        for x in [-0.5, -0.1, 0.0, 0.2, 0.6] {
            assert!((sensing.inverse(sensing.curve(x)) - x).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn a_lagged_ramp_is_late_by_the_time_constant() {
        let sensing = Sensing {
            lag_s: 5e-3,
            ..Sensing::ideal()
        };
        let mut reading = Reading::at_rest(&sensing, 0.0);
        let mut y = 0.0;
        for i in 1..=100 {
            y = reading.follow(&sensing, 2.0 * f64::from(i) * 1e-3, 1e-3);
        }
        assert!((y - (0.2 - 2.0 * 5e-3)).abs() < 1e-9);
    }

    #[test]
    fn the_step_response_of_two_lags_matches_their_equation() {
        // y = 1 − (1 + t/τ) e^(−t/τ)
        let lag_s = 5e-3;
        let sensing = Sensing {
            lag_s,
            further_lag_s: lag_s,
            ..Sensing::ideal()
        };
        let mut reading = Reading::at_rest(&sensing, 0.0);
        reading.follow(&sensing, 1.0, 1e-9);
        for i in 1..=40 {
            let y = reading.follow(&sensing, 1.0, 5e-4);
            let t = f64::from(i) * 5e-4 / lag_s;
            let expected = 1.0 - (1.0 + t) * (-t).exp();
            assert!((y - expected).abs() < 1e-3, "{y} {expected}");
        }
    }

    #[test]
    fn counts_lost_above_the_speed_limit_stay_lost() {
        let overspeed = Overspeed {
            share: 0.25,
            speed: 2.0,
        };
        let sensing = Sensing {
            overspeed,
            ..Sensing::ideal()
        };
        let mut reading = Reading::at_rest(&sensing, 0.0);
        // A motion by 1 rad at 10 rad/s, and slowly back.
        let there = reading.follow(&sensing, 1.0, 0.1);
        assert!((there - (1.0 - 0.25 * 8.0 * 0.1)).abs() < 1e-12);
        assert!((reading.follow(&sensing, 0.0, 1.0) + 0.2).abs() < 1e-12);
        for rate in [-10.0, -1.0, 0.5, 2.0, 9.0] {
            let shown = rate - overspeed.lost(rate);
            assert!((overspeed.undone(shown) - rate).abs() < 1e-12);
        }
    }

    #[test]
    fn with_play_the_reading_stays_constant_after_a_reversal() {
        let sensing = Sensing {
            hysteresis: Hysteresis {
                half_width: 0.01,
                ..Hysteresis::NONE
            },
            ..Sensing::ideal()
        };
        let mut reading = Reading::at_rest(&sensing, 0.0);
        let up = reading.follow(&sensing, 0.1, 1e-3);
        let back = reading.follow(&sensing, 0.085, 1e-3);
        assert!((up - 0.09).abs() < 1e-12 && up == back);
        assert!((reading.follow(&sensing, 0.05, 1e-3) - 0.06).abs() < 1e-12);
    }
}
