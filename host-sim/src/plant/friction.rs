//! Dry friction: the level that opposes sliding, and the one that holds at rest.

use super::drift::Drift;
use super::spot::Spot;
use super::stribeck::Stribeck;
use crate::ripple::Ripple;

/// Dry friction with stick and slip. The level in one direction is
///
/// `F(x, v, t, T) = s · p(x) · d(t) · [1 + (r − 1) e^−|v/v_s|ⁿ] + µ |T|`
///
/// with the level `s` of the direction of motion, a [`Stribeck`] factor and a share µ of the transmitted torque T.
/// Where T acts against the motion, the load drives the motor, and µ is another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Sliding level against positive and against negative motion, N m.
    pub level_nm: [f64; 2],
    /// Fall from the static to the sliding level.
    pub stribeck: Stribeck,
    /// Dependence on position: `p = max(0, 1 + slope x + curve x² + r sin(n x) + s (cos(n x) − 1) + h exp(−|(x − c)/w|^m))`.
    pub position_slope: f64,
    /// Curvature of the dependence on position, 1/rad².
    pub position_curve: f64,
    /// The ripple of the dependence on position: the terms of r and s.
    pub position_ripple: Ripple,
    /// The spot of the dependence on position: the term of h.
    pub position_spot: Spot,
    /// Share µ of the transmitted torque that is added to the level, where the motor drives.
    pub load_share: f64,
    /// Change of the share µ where the load drives the motor. The sum of both is never below zero.
    pub load_backdriven_extra: f64,
    /// Part of the torque of gravity and springs that is transmitted in addition to the driving torque.
    pub load_passive: f64,
    /// Dependence on time, if any: `d = max(0, 1 + growth(t))`.
    pub drift: Option<Drift>,
}

impl Friction {
    /// Coulomb friction: one level in both directions, at rest and sliding.
    pub fn coulomb(level_nm: f64) -> Self {
        Self {
            level_nm: [level_nm; 2],
            stribeck: Stribeck::NONE,
            position_slope: 0.0,
            position_curve: 0.0,
            position_ripple: Ripple::NONE,
            position_spot: Spot::NONE,
            load_share: 0.0,
            load_backdriven_extra: 0.0,
            load_passive: 0.0,
            drift: None,
        }
    }

    /// This friction with the level in both directions multiplied by `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.level_nm = self.level_nm.map(|level| factor * level);
    }

    /// Sliding level against motion in `direction` (±1) before any dependence on position, speed, time or load, N m.
    #[inline]
    pub fn level(&self, direction: f64) -> f64 {
        self.level_nm[usize::from(direction < 0.0)]
    }

    /// The higher of the sliding levels, N m.
    #[inline]
    pub fn highest_nm(&self) -> f64 {
        self.level_nm[0].max(self.level_nm[1])
    }

    /// True if there is no dry friction.
    pub fn is_none(&self) -> bool {
        self.level_nm == [0.0; 2] && self.is_without_load_share()
    }

    /// True if the level depends on direction and time alone.
    pub(super) fn is_level(&self) -> bool {
        self.stribeck.is_none()
            && self.position_slope == 0.0
            && self.position_curve == 0.0
            && self.position_ripple.is_none()
            && self.position_spot.is_none()
            && self.is_without_load_share()
    }

    /// True if no transmitted torque adds friction.
    pub(super) fn is_without_load_share(&self) -> bool {
        self.load_share == 0.0 && self.load_backdriven_extra == 0.0
    }

    /// Sliding level against motion in `direction` (±1), N m.
    #[inline]
    pub fn sliding(
        &self,
        direction: f64,
        position: f64,
        speed: f64,
        t_s: f64,
        transmitted_nm: f64,
    ) -> f64 {
        let stribeck = self.stribeck.factor(speed);
        self.scaled(direction, position, t_s) * stribeck + self.by_load(direction, transmitted_nm)
    }

    /// Level that holds against a push in `direction` (±1) at rest, N m.
    #[inline]
    pub fn holding(&self, direction: f64, position: f64, t_s: f64, transmitted_nm: f64) -> f64 {
        self.scaled(direction, position, t_s) * self.stribeck.ratio
            + self.by_load(direction, transmitted_nm)
    }

    /// Friction that the transmitted torque adds against motion in `direction` (±1), N m.
    #[inline]
    fn by_load(&self, direction: f64, transmitted_nm: f64) -> f64 {
        let share = if direction * transmitted_nm < 0.0 {
            (self.load_share + self.load_backdriven_extra).max(0.0)
        } else {
            self.load_share
        };
        share * transmitted_nm.abs()
    }

    #[inline]
    fn scaled(&self, direction: f64, x: f64, t_s: f64) -> f64 {
        let mut p = 1.0 + x * (self.position_slope + x * self.position_curve);
        if !self.position_ripple.is_none() {
            p += self.position_ripple.at(x);
        }
        if !self.position_spot.is_none() {
            p += self.position_spot.at(x);
        }
        let drift = self.drift.as_ref();
        let d = drift.map_or(1.0, |drift| drift.factor(t_s));
        self.level(direction) * p.max(0.0) * d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_friction_of_a_gear_differs_when_the_load_drives_it() {
        let gear = Friction {
            load_share: 0.1,
            load_backdriven_extra: 0.2,
            ..Friction::coulomb(2.0)
        };
        let level =
            |direction, transmitted_nm| gear.sliding(direction, 0.0, 0.1, 0.0, transmitted_nm);
        for (direction, transmitted_nm, expected) in
            [(1.0, 5.0, 2.5), (1.0, -5.0, 3.5), (-1.0, -5.0, 2.5)]
        {
            let level = level(direction, transmitted_nm);
            assert!((level - expected).abs() < 1e-12, "{level} for {expected}");
        }
    }

    #[test]
    fn a_spot_raises_the_friction_only_near_its_position() {
        let spot = Friction {
            position_spot: Spot {
                height: 1.5,
                position: 0.3,
                width: 0.1,
                exponent: Spot::BELL,
            },
            ..Friction::coulomb(2.0)
        };
        let level = |x| spot.sliding(1.0, x, 0.1, 0.0, 0.0);
        assert!((level(0.3) - 5.0).abs() < 1e-12);
        assert!((level(0.4) - (2.0 + 3.0 * (-1.0f64).exp())).abs() < 1e-12);
        assert!((level(-0.3) - 2.0).abs() < 1e-12);
    }
}
