//! Static friction above the sliding level.

/// How dry friction falls from its static to its sliding level with speed: the factor
///
/// `1 + (r − 1) (1 + t p)^(−1/t)`, p = |v/v_s|ⁿ
///
/// With t = 0 it is `1 + (r − 1) e^−p` of Bo and Pavelescu (Wear 82, 1982): with n = 2 that of Armstrong-Hélouvry,
/// Dupont and Canudas de Wit (Automatica 30, 1994), with n = 1 that of Tustin (IEE 94, 1947). With t = 1 and n = 2 it
/// is that of Hess and Soom (Journal of Tribology 112, 1990).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck {
    /// Static level over the sliding level, r.
    pub ratio: f64,
    /// Speed over which the level falls, `v_s`, rad/s.
    pub velocity: f64,
    /// Steepness n of the fall, 1 or more.
    pub exponent: f64,
    /// Tail t of the fall: 0 for an exponential, up to 1 for a hyperbola.
    pub tail: f64,
}

/// Logarithms of the ratio of the steepest slope to the slope in the tail and where the curve counts as flat: 10 and
/// 1e4.
const IN_TAIL: f64 = 2.3;
const FLAT: f64 = 9.2;
/// Power from which the exponential is 0 in double precision: exp(−36) is 2e-16.
const GONE_FROM: f64 = 36.0;
impl Stribeck {
    /// One level at rest and sliding.
    pub const NONE: Self = Self {
        ratio: 1.0,
        velocity: 0.0,
        exponent: 2.0,
        tail: 0.0,
    };

    /// True if the levels are the same.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.ratio == 1.0
    }

    /// Factor of the sliding level at a speed in rad/s.
    #[inline]
    pub fn factor(&self, speed: f64) -> f64 {
        // At most speeds of a motion the exponential is 0 in double precision.
        let is_gone = self.tail == 0.0 && speed >= GONE_FROM * self.velocity;
        if is_gone || self.is_none() {
            return 1.0;
        }
        1.0 + (self.ratio - 1.0) * self.left(self.power(speed / self.velocity))
    }

    /// Share of the static friction's excess that is left at `power`.
    #[inline]
    fn left(&self, power: f64) -> f64 {
        match self.tail {
            0.0 if power >= GONE_FROM => 0.0,
            0.0 => (-power).exp(),
            1.0 => (1.0 + power).recip(),
            tail => (1.0 + tail * power).powf(-tail.recip()),
        }
    }

    /// Speed from which the slope is below the steepest one by a factor e^`gentler`, rad/s.
    fn gentle_from(&self, gentler: f64) -> f64 {
        let power = match self.tail {
            0.0 => gentler,
            tail => (gentler * tail / (1.0 + tail)).exp_m1() / tail,
        };
        self.root(power) * self.velocity
    }

    /// `xⁿ`, without a power function for the usual n.
    #[inline]
    fn power(&self, x: f64) -> f64 {
        match self.exponent {
            1.0 => x,
            2.0 => x * x,
            n => x.powf(n),
        }
    }

    /// The n-th root of `power`.
    #[inline]
    fn root(&self, power: f64) -> f64 {
        match self.exponent {
            1.0 => power,
            2.0 => power.sqrt(),
            n => power.powf(n.recip()),
        }
    }

    /// The slope on which an inertia slides, with a sliding level of `level_nm`.
    pub(super) fn slope(&self, inertia: f64, level_nm: f64) -> Slope {
        let steepest = (0.5 * self.exponent).max(1.0) * (self.ratio - 1.0).abs();
        let rate = steepest * level_nm / (inertia * self.velocity);
        Slope {
            velocity: self.velocity,
            tail_from: self.gentle_from(if self.tail > 0.0 { IN_TAIL } else { FLAT }),
            flat_from: self.gentle_from(FLAT),
            rate,
            tail_rate: rate * (-IN_TAIL).exp(),
            inertia,
            level_nm: level_nm * self.ratio,
        }
    }
}

/// The fall of friction with speed, for one inertia.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    /// Speeds, rad/s: over which friction falls, from which the fall is that of the tail, and from which it counts as
    /// flat.
    velocity: f64,
    tail_from: f64,
    flat_from: f64,
    /// Rates at which a speed grows by the fall, 1/s: on the steepest part and in the tail.
    rate: f64,
    tail_rate: f64,
    inertia: f64,
    /// Highest level, N m.
    level_nm: f64,
}

/// Limits of a step on a slope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stride {
    /// Product of the slope's rate and the step.
    pub rate_step: f64,
    /// Largest change of the speed, as a share of the Stribeck velocity.
    pub share: f64,
}

impl Slope {
    /// The longest step, s, that neither is long for the slope nor leaps over it. `pull_nm` is the torque without dry
    /// friction.
    #[inline]
    pub(super) fn longest_step(&self, speed: f64, pull_nm: f64, stride: Stride) -> f64 {
        let reaching = |from: f64| {
            let leap = (speed - from).max(stride.share * self.velocity);
            leap * self.inertia / (pull_nm.abs() + self.level_nm)
        };
        if speed > self.flat_from {
            return reaching(self.flat_from);
        }
        let rate = if speed > self.tail_from {
            self.tail_rate
        } else {
            self.rate
        };
        reaching(self.tail_from).min(stride.rate_step / rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_falls_to_1_over_e_at_the_stribeck_velocity_for_every_exponent() {
        for exponent in [1.0, 1.5, 2.0, 4.0] {
            let stribeck = Stribeck {
                ratio: 1.5,
                velocity: 0.2,
                exponent,
                tail: 0.0,
            };
            assert_eq!(stribeck.factor(0.0), 1.5);
            assert!((stribeck.factor(0.2) - 1.0 - 0.5 * (-1.0f64).exp()).abs() < 1e-12);
            let half = 1.0 + 0.5 * (-(0.5f64.powf(exponent))).exp();
            assert!((stribeck.factor(0.1) - half).abs() < 1e-12);
            assert_eq!(stribeck.factor(7.3), 1.0);
        }
    }

    #[test]
    fn the_tail_may_be_a_hyperbola_or_between_it_and_an_exponential() {
        let factor = |tail, speed| {
            let stribeck = Stribeck {
                ratio: 1.5,
                velocity: 0.2,
                exponent: 2.0,
                tail,
            };
            stribeck.factor(speed)
        };
        assert_eq!(factor(1.0, 0.2), 1.25);
        assert_eq!(factor(1.0, 2.0), 1.0 + 0.5 / 101.0);
        assert!((factor(1e-6, 0.1) - factor(0.0, 0.1)).abs() < 1e-6);
        assert!(factor(0.0, 1.0) < factor(0.5, 1.0) && factor(0.5, 1.0) < factor(1.0, 1.0));
    }
}
