//! The elastic part of dry friction.

/// Bristles that bend before they slide and replace sticking, after Dahl ("A solid friction model", 1968) with the
/// damping of the LuGre model of Canudas de Wit, Olsson, Åström and Lischinsky (IEEE TAC 40, 1995),
///
/// `z' = v (1 − z sgn v / z_s)ⁿ`, `F = (z / z_s) F_sliding + σ₁ z'`.
///
/// With n = 1 it is the LuGre model; towards 0 the bristles slide more suddenly. With an elastic share e above 0 they are
/// purely elastic up to e z_s and on their way back (Dupont, Hayward, Armstrong and Altpeter, IEEE TAC 47, 2002):
///
/// `z' = v (1 − s)ⁿ`, `s = max(0, (z sgn v / z_s − e) / (1 − e))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presliding {
    /// Deflection `z_s` at which the bristles slide, rad.
    pub distance: f64,
    /// Damping σ₁ of the bristles, N m s/rad.
    pub damping: f64,
    /// Dahl's exponent n.
    pub exponent: f64,
    /// Share e of `z_s` up to which they are purely elastic, below 1; 0 if they never are.
    pub elastic: f64,
}

/// Share of the sliding deflection at which bristles count as sliding.
const SLID: f64 = 0.98;
/// Lowest fraction of the way to sliding after a step that is too long. It limits the elastic return of the bristles to the
/// speed at which they bend.
const FARTHEST_BACK: f64 = -1.0;
/// Share of the way to sliding below which the exponent counts as 1, because no solver can follow a root to its end.
const LAST: f64 = 0.02;

impl Presliding {
    /// No bristles.
    pub(super) const NONE: Self = Self {
        distance: 0.0,
        damping: 0.0,
        exponent: 0.0,
        elastic: 0.0,
    };

    /// The bristles with their stiffness and damping limited to those of bristles on which an inertia rings at `rate`,
    /// rad/s, and is critically damped. `level_nm` is the friction level, N m.
    pub fn bounded(self, inertia: f64, level_nm: f64, rate: f64) -> Self {
        Self {
            distance: self.distance.max(level_nm / (rate * rate * inertia)),
            damping: self.damping.min(2.0 * rate * inertia),
            ..self
        }
    }

    /// Rate of the deflection, rad/s.
    #[inline]
    pub(super) fn rate(&self, velocity: f64, deflection: f64) -> f64 {
        let bent = deflection * velocity.signum() / self.distance;
        let left = if self.elastic > 0.0 {
            (1.0 - bent).min(1.0 - self.elastic) / (1.0 - self.elastic)
        } else {
            1.0 - bent
        };
        let left = left.max(FARTHEST_BACK);
        if self.exponent == 1.0 {
            velocity * left
        } else if left < LAST {
            velocity * left * LAST.powf(self.exponent - 1.0)
        } else {
            velocity * left.powf(self.exponent)
        }
    }

    /// Natural rate of an inertia on bristles of this sliding level, 1/s.
    #[inline]
    pub(super) fn natural_rate(&self, inertia: f64, level_nm: f64) -> f64 {
        (level_nm / self.distance / inertia).sqrt()
    }

    /// Longest step over which the deflection follows a velocity, s: to the end of the elastic part, or one time
    /// constant of the relaxation if that is longer.
    #[inline]
    pub(super) fn longest_step(&self, velocity: f64, deflection: f64) -> f64 {
        let bent = deflection * velocity.signum();
        let elastic = self.elastic * self.distance - bent;
        elastic.max((1.0 - self.elastic) * self.distance) / velocity.abs()
    }

    /// True if the deflection has settled and would relax faster than a step of `step_s` can follow.
    #[inline]
    pub(super) fn has_slid(&self, velocity: f64, deflection: f64, step_s: f64) -> bool {
        self.may_slide(velocity, step_s) && deflection * velocity.signum() > SLID * self.distance
    }

    /// True if a settled deflection would relax faster than a step of `step_s` can follow.
    #[inline]
    pub(super) fn may_slide(&self, velocity: f64, step_s: f64) -> bool {
        velocity.abs() * step_s > (1.0 - self.elastic) * self.distance
    }

    /// Natural rate plus damping of an inertia on bristles of this sliding level, 1/s.
    pub(super) fn fastest_rate(&self, inertia: f64, level_nm: f64) -> f64 {
        self.natural_rate(inertia, level_nm) + self.damping / inertia
    }
}

/// Terms of the binomial series that replaces a power on a short way, and the largest argument of that series. Its
/// error is below 1e-9.
const TERMS: usize = 6;
const SHORT: f64 = 0.15;

/// Bristles that are bent by one way after the other.
#[derive(Clone, Copy)]
pub(super) struct Bending<'a> {
    bristles: &'a Presliding,
    deflection: f64,
    last: Option<Way>,
    /// Ratios of the terms of (1 − u)^p, with p = 1/(1 − n): each term over the one before it, over u.
    ratios: [f64; TERMS],
    /// Largest |u| for which the series is used.
    short: f64,
}

/// The end of a way in one direction.
#[derive(Clone, Copy)]
struct Way {
    side: f64,
    /// Share of the yielding part that is left, and that share to the power 1 − n, from which the next way continues.
    left: f64,
    power: f64,
}

impl<'a> Bending<'a> {
    pub(super) fn from(bristles: &'a Presliding, deflection: f64) -> Self {
        let p = (1.0 - bristles.exponent).recip();
        Self {
            bristles,
            deflection,
            last: None,
            ratios: core::array::from_fn(|k| (k as f64 - p) / (k + 1) as f64),
            short: SHORT / p.abs().max(1.0),
        }
    }

    /// (1 − u)^p by its series.
    #[inline]
    fn power(&self, u: f64) -> f64 {
        let ratios = self.ratios.iter().rev();
        ratios.fold(1.0, |sum, ratio| 1.0 + ratio * u * sum)
    }

    #[inline]
    pub(super) fn deflection(&self) -> f64 {
        self.deflection
    }

    /// Bends the bristles by a further `way`, rad, in closed form. Time does not matter.
    #[inline]
    pub(super) fn go(&mut self, way: f64) {
        if way == 0.0 {
            return;
        }
        let &Presliding {
            distance,
            exponent,
            elastic,
            ..
        } = self.bristles;
        let side = 1f64.copysign(way);
        let mut bent = side * self.deflection / distance;
        let mut on = way.abs() / distance;
        let mut last = self.last.filter(|last| last.side == side);
        if elastic > 0.0 {
            let freely = (elastic - bent).max(0.0).min(on);
            if freely > 0.0 {
                last = None;
            }
            bent += freely;
            on -= freely;
        }
        let yields = 1.0 - elastic;
        let before = ((1.0 - bent) / yields).max(0.0);
        let left = if exponent == 1.0 {
            before * (-on / yields).exp()
        } else {
            let rest = 1.0 - exponent;
            let by = rest * on / yields;
            let was = last.map_or_else(|| before.powf(rest), |last| last.power);
            let power = (was - by).max(0.0);
            let left = match last {
                Some(last) if by.abs() <= self.short * was => last.left * self.power(by / was),
                _ => power.powf(rest.recip()),
            };
            // In the elastic part nothing has yielded.
            self.last = (on > 0.0).then_some(Way { side, left, power });
            left
        };
        self.deflection = side * distance * (1.0 - yields * left);
    }

    /// Derivative of the deflection over the way, in the direction of `velocity`.
    #[inline]
    pub(super) fn bends(&self, velocity: f64) -> f64 {
        match self.last {
            Some(last) if last.side * velocity > 0.0 && last.left >= LAST => last.left / last.power,
            _ if velocity == 0.0 => 1.0,
            _ => self.bristles.rate(velocity, self.deflection) / velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deflection_matches_dahls_equation() {
        // z / z_s over the way x, from rest: 1 − e^(−x/z_s) for n = 1, 1 − (1 − x/(2 z_s))² for n = ½.
        let distance = 0.01;
        for (exponent, bent) in [
            (1.0, 1.0 - (-0.8f64).exp()),
            (0.5, 1.0 - (1.0f64 - 0.4).powi(2)),
        ] {
            let bristles = Presliding {
                distance,
                damping: 0.0,
                exponent,
                elastic: 0.0,
            };
            let (steps, velocity) = (80_000, -0.3);
            let dt = 0.8 * distance / 0.3 / f64::from(steps);
            let z = (0..steps).fold(0.0, |z, _| z + dt * bristles.rate(velocity, z));
            assert!((z / distance + bent).abs() < 1e-4, "{exponent}: {z}");
        }
    }

    #[test]
    fn one_long_way_equals_many_short_ones() {
        for (exponent, elastic) in [(1.0, 0.0), (1.0, 0.6), (0.4, 0.0), (1.8, 0.3)] {
            let bristles = Presliding {
                distance: 0.01,
                damping: 0.0,
                exponent,
                elastic,
            };
            // Forwards, back past the middle, and forwards again.
            let mut bending = Bending::from(&bristles, 0.0);
            let mut z = 0.0;
            for way in [0.008, -0.013, 0.002, 0.009, 0.009] {
                bending.go(way);
                let steps = 100_000;
                let dt = way.abs() / f64::from(steps);
                for _ in 0..steps {
                    z += dt * bristles.rate(way.signum(), z);
                }
                let bent = bending.deflection();
                let bends = bristles.rate(way, bent) / way;
                assert!((bending.bends(way) - bends).abs() < 1e-9, "{exponent}");
                assert!((bent - z).abs() < 2e-5, "{exponent} {elastic}: {bent}, {z}");
            }
        }
    }

    #[test]
    fn many_short_ways_equal_one_long_way() {
        for (exponent, elastic) in [(0.4, 0.0), (0.97, 0.0), (1.8, 0.3)] {
            let bristles = Presliding {
                distance: 0.01,
                damping: 0.0,
                exponent,
                elastic,
            };
            let [mut whole, mut parts] = [Bending::from(&bristles, 0.0); 2];
            for way in [0.008, -0.013, 0.009] {
                whole.go(way);
                (0..1000).for_each(|_| parts.go(way / 1000.0));
                let apart = (whole.deflection() - parts.deflection()).abs();
                assert!(apart < 1e-11, "{exponent}: {apart}");
            }
        }
    }

    #[test]
    fn bounded_bristles_ring_at_the_given_rate_at_most() {
        let (inertia, level_nm, rate) = (2e-4, 0.04, 1500.0);
        let bristles = |distance, damping| Presliding {
            distance,
            damping,
            exponent: 1.0,
            elastic: 0.0,
        };
        let soft = bristles(0.01, 0.02);
        assert_eq!(soft.bounded(inertia, level_nm, rate), soft);
        let stiff = bristles(1e-5, 2.0).bounded(inertia, level_nm, rate);
        let natural = stiff.natural_rate(inertia, level_nm);
        assert!((natural / rate - 1.0).abs() < 1e-12, "{natural} rad/s");
        let ratio = stiff.damping / (2.0 * rate * inertia);
        assert!((ratio - 1.0).abs() < 1e-12, "{ratio} of critical");
    }

    #[test]
    fn bristles_tolerate_a_diverging_motion() {
        let bristles = Presliding {
            distance: 0.01,
            damping: 0.0,
            exponent: 0.4,
            elastic: 0.3,
        };
        let mut bending = Bending::from(&bristles, 0.0);
        for way in [f64::INFINITY, f64::NAN, 0.01] {
            bending.go(way);
        }
    }

    #[test]
    fn elastic_bristles_follow_the_motion_back() {
        let bristles = Presliding {
            distance: 0.01,
            damping: 0.0,
            exponent: 1.0,
            elastic: 0.4,
        };
        // The deflection follows the motion below the elastic share and on the way back, and half of it in the middle
        // between the elastic share and sliding.
        assert_eq!(bristles.rate(2.0, 0.0039), 2.0);
        assert_eq!(bristles.rate(-2.0, 0.0099), -2.0);
        assert!((bristles.rate(2.0, 0.007) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bristles_never_bend_beyond_the_sliding_deflection() {
        let bristles = Presliding {
            distance: 0.01,
            damping: 0.0,
            exponent: 0.1,
            elastic: 0.0,
        };
        let z = (0..40_000).fold(0.0, |z, _| z + 1e-6 * bristles.rate(0.5, z));
        assert!(z > 0.97 * 0.01 && z < 1.01 * 0.01, "{z}");
    }
}
