//! Static friction above the sliding level.

/// How dry friction falls from its static to its sliding level with speed: the factor
///
/// `1 + (r − 1) e^−|v/v_s|ⁿ`
///
/// of Bo and Pavelescu (Wear 82, 1982), with n of 2 that of Armstrong-Hélouvry, Dupont and Canudas de Wit (Automatica 30,
/// 1994), with n of 1 that of Tustin (IEE 94, 1947).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck {
    /// Static level over the sliding level, r.
    pub ratio: f64,
    /// Speed over which the level falls, `v_s`, rad/s.
    pub velocity: f64,
    /// How suddenly it falls, n, 1 or more.
    pub exponent: f64,
}

/// Power of the exponential from which the curve is flat to 1e-4.
const FLAT_FROM: f64 = 9.2;
/// And from which nothing of it is left: exp(−36) is 2e-16.
const GONE_FROM: f64 = 36.0;
impl Stribeck {
    /// One level at rest and sliding.
    pub const NONE: Self = Self {
        ratio: 1.0,
        velocity: 0.0,
        exponent: 2.0,
    };

    /// True if the levels are the same.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.ratio == 1.0
    }

    /// Of the sliding level, at a speed in rad/s.
    #[inline]
    pub fn factor(&self, speed: f64) -> f64 {
        // Most of the motion is beyond the reach of double precision.
        if self.is_none() || speed >= GONE_FROM * self.velocity {
            return 1.0;
        }
        let power = self.power(speed / self.velocity);
        if power >= GONE_FROM {
            return 1.0;
        }
        1.0 + (self.ratio - 1.0) * (-power).exp()
    }

    /// `xⁿ`, at little cost for the usual n.
    #[inline]
    fn power(&self, x: f64) -> f64 {
        match self.exponent {
            1.0 => x,
            2.0 => x * x,
            n => x.powf(n),
        }
    }

    /// Of which `power` is the n-th power.
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
        Slope {
            velocity: self.velocity,
            flat_from: self.root(FLAT_FROM) * self.velocity,
            rate: steepest * level_nm / (inertia * self.velocity),
            inertia,
            level_nm: level_nm * self.ratio,
        }
    }
}

/// How friction falls with the speed of an inertia.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    /// Speed over which it falls, and beyond which it is flat, rad/s.
    velocity: f64,
    flat_from: f64,
    /// At which the speed grows where it is steepest, 1/s.
    rate: f64,
    inertia: f64,
    /// At most, N m.
    level_nm: f64,
}

/// How far a step may go on a slope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stride {
    /// Product of the slope's rate and the step.
    pub rate_step: f64,
    /// Share of the Stribeck velocity that the speed may change by.
    pub share: f64,
}

impl Slope {
    /// The longest step, s, where `pull_nm` is all but dry friction: neither long for the slope nor a leap over it.
    #[inline]
    pub(super) fn longest_step(&self, speed: f64, pull_nm: f64, stride: Stride) -> f64 {
        let leap = (speed - self.flat_from).max(stride.share * self.velocity);
        let reaching = leap * self.inertia / (pull_nm.abs() + self.level_nm);
        if speed > self.flat_from {
            return reaching;
        }
        reaching.min(stride.rate_step / self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_to_an_eth_part_over_its_velocity_however_suddenly() {
        for exponent in [1.0, 1.5, 2.0, 4.0] {
            let stribeck = Stribeck {
                ratio: 1.5,
                velocity: 0.2,
                exponent,
            };
            assert_eq!(stribeck.factor(0.0), 1.5);
            assert!((stribeck.factor(0.2) - 1.0 - 0.5 * (-1.0f64).exp()).abs() < 1e-12);
            let half = 1.0 + 0.5 * (-(0.5f64.powf(exponent))).exp();
            assert!((stribeck.factor(0.1) - half).abs() < 1e-12);
            assert_eq!(stribeck.factor(7.3), 1.0);
        }
    }
}
