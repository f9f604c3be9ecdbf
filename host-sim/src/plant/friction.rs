//! Dry friction: the level that opposes sliding, and the one that holds at rest.

use crate::ripple::Ripple;

/// Dry friction with stick and slip. The level in one direction is
///
/// `F(x, v, t, T) = s · p(x) · d(t) · [1 + (r − 1) e^−(v/v_s)²] + µ |T|`
///
/// with the level `s` of the direction of motion, the Stribeck term of Armstrong-Hélouvry,
/// Dupont and Canudas de Wit (Automatica 30, 1994), and a share µ of the driving torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Sliding level against positive and against negative motion, N m.
    pub level_nm: [f64; 2],
    /// Level at rest over the sliding level, 1 or more.
    pub static_ratio: f64,
    /// Speed over which the level falls from static to sliding, rad/s.
    pub stribeck_velocity: f64,
    /// Dependence on position: `p = max(0, 1 + slope x + curve x² + r sin(n x) + s (cos(n x) − 1))` with
    /// x from the centre.
    pub position_slope: f64,
    /// Likewise, 1/rad².
    pub position_curve: f64,
    /// Likewise, its last two terms.
    pub position_ripple: Ripple,
    /// Likewise, rad.
    pub position_centre: f64,
    /// Share of the driving torque that is added to the level.
    pub load_share: f64,
    /// Dependence on time, if any: `d = max(0, 1 + growth(t))`.
    pub drift: Option<Drift>,
}

/// Growth of a level as something warms up: `r τ (1 − e^(−t/τ))`, or `r t` where it never settles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Relative, at the start, 1/s.
    pub rate_per_s: f64,
    /// Time constant with which it settles, s.
    pub settling_s: Option<f64>,
}

impl Drift {
    #[inline]
    fn growth(&self, t_s: f64) -> f64 {
        let since_s = match self.settling_s {
            Some(settling_s) => -settling_s * (-t_s / settling_s).exp_m1(),
            None => t_s,
        };
        self.rate_per_s * since_s
    }
}

/// Stribeck velocities beyond which the curve is flat to 1e-4.
const FLAT_FROM: f64 = 3.0;
/// Stribeck velocities beyond which nothing of the curve is left: exp(−36) is 2e-16.
const GONE_FROM: f64 = 6.0;
/// Share of the Stribeck velocity that a fourth-order step may gain: it then misses 1e-4 of the fall.
const SLOPE_SHARE: f64 = 0.5;

impl Friction {
    /// The same level in both directions, at rest and sliding.
    pub fn coulomb(level_nm: f64) -> Self {
        Self {
            level_nm: [level_nm; 2],
            static_ratio: 1.0,
            stribeck_velocity: 0.0,
            position_slope: 0.0,
            position_curve: 0.0,
            position_ripple: Ripple::NONE,
            position_centre: 0.0,
            load_share: 0.0,
            drift: None,
        }
    }

    /// Multiplies the level in both directions.
    pub fn scale(&mut self, factor: f64) {
        self.level_nm = self.level_nm.map(|level| factor * level);
    }

    /// True if there is none at all.
    pub fn is_none(&self) -> bool {
        self.level_nm == [0.0; 2] && self.load_share == 0.0
    }

    /// True if the level depends on the direction alone.
    pub(super) fn is_plain(&self) -> bool {
        self.static_ratio == 1.0
            && self.position_slope == 0.0
            && self.position_curve == 0.0
            && self.position_ripple.is_none()
            && self.load_share == 0.0
            && self.drift.is_none()
    }

    /// Sliding level against motion in `direction` (±1), N m.
    #[inline]
    pub fn sliding(
        &self,
        direction: f64,
        position: f64,
        speed: f64,
        t_s: f64,
        drive_nm: f64,
    ) -> f64 {
        // Not beyond the reach of double precision, where most of the motion is.
        let falling = self.static_ratio != 1.0 && speed < GONE_FROM * self.stribeck_velocity;
        let stribeck = if falling {
            let x = speed / self.stribeck_velocity;
            1.0 + (self.static_ratio - 1.0) * (-x * x).exp()
        } else {
            1.0
        };
        self.scaled(direction, position, t_s) * stribeck + self.load_share * drive_nm.abs()
    }

    /// Level that holds against a push in `direction` (±1) at rest, N m.
    #[inline]
    pub fn holding(&self, direction: f64, position: f64, t_s: f64, drive_nm: f64) -> f64 {
        self.scaled(direction, position, t_s) * self.static_ratio + self.load_share * drive_nm.abs()
    }

    /// The longest step of an inertia on the falling slope of the Stribeck curve, s, with `push_nm` the most that
    /// accelerates it.
    ///
    /// A step must neither be long for the slope nor leap over it.
    #[inline]
    pub(super) fn longest_step(&self, inertia: f64, speed: f64, push_nm: f64, share: f64) -> f64 {
        if self.static_ratio == 1.0 {
            return f64::INFINITY;
        }
        let flat_from = FLAT_FROM * self.stribeck_velocity;
        let leap = (speed - flat_from).max(SLOPE_SHARE * self.stribeck_velocity);
        let reaching = leap * inertia / push_nm;
        if speed > flat_from {
            return reaching;
        }
        let level = self.level_nm[0].max(self.level_nm[1]);
        let slope = (self.static_ratio - 1.0).abs() * level / self.stribeck_velocity;
        reaching.min(share * inertia / slope)
    }

    #[inline]
    fn scaled(&self, direction: f64, position: f64, t_s: f64) -> f64 {
        let x = position - self.position_centre;
        let mut p = 1.0 + x * (self.position_slope + x * self.position_curve);
        if !self.position_ripple.is_none() {
            p += self.position_ripple.at(x);
        }
        let d = 1.0 + self.drift.map_or(0.0, |drift| drift.growth(t_s));
        self.level_nm[usize::from(direction < 0.0)] * p.max(0.0) * d.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_that_drifts_grows_on_or_settles() {
        let level = |settling_s, t_s| {
            let drift = Some(Drift {
                rate_per_s: 0.1,
                settling_s,
            });
            let friction = Friction {
                drift,
                ..Friction::coulomb(2.0)
            };
            friction.holding(1.0, 0.0, t_s, 0.0)
        };
        assert!((level(None, 30.0) - 8.0).abs() < 1e-12);
        assert!((level(Some(10.0), 10.0) - 2.0 * (2.0 - (-1.0f64).exp())).abs() < 1e-12);
        assert!((level(Some(10.0), 1e3) - 4.0).abs() < 1e-12);
    }
}
