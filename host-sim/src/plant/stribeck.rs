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
/// Share of the Stribeck velocity that a fourth-order step may gain: it then misses 1e-4 of the fall.
const SLOPE_SHARE: f64 = 0.5;

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

    /// The longest step of an inertia on the falling slope, s, with `push_nm` the most that accelerates it and a sliding
    /// level of `level_nm`: neither long for the slope nor a leap over it.
    #[inline]
    pub(super) fn longest_step(
        &self,
        inertia: f64,
        speed: f64,
        push_nm: f64,
        level_nm: f64,
        share: f64,
    ) -> f64 {
        if self.is_none() {
            return f64::INFINITY;
        }
        let flat_from = self.root(FLAT_FROM) * self.velocity;
        let leap = (speed - flat_from).max(SLOPE_SHARE * self.velocity);
        let reaching = leap * inertia / push_nm;
        if speed > flat_from {
            return reaching;
        }
        let steepest = (0.5 * self.exponent).max(1.0) * (self.ratio - 1.0).abs();
        reaching.min(share * inertia * self.velocity / (steepest * level_nm))
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
