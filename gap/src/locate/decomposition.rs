//! Splits the missing acceleration into a constant, a Coulomb friction, and a remainder that an axis may explain.

use super::innovation::Innovation;
use crate::fit::whitening::dot;

/// The missing acceleration, by a robust measure, as a constant, a term with the sign of the velocity, and a remainder.
#[derive(Clone, Debug)]
pub(super) struct Decomposition {
    /// Share of the sum of squares that only a constant explains: a constant torque that the model lacks.
    pub constant: f64,
    /// Share of the sum of squares that only a term with the sign of the velocity explains: Coulomb friction.
    pub direction: f64,
    /// Remainder of each innovation.
    pub remainder: Vec<f64>,
    /// Share of the sum of squares in the remainder.
    pub remainder_share: f64,
}

impl Decomposition {
    pub(super) fn of(all: &[Innovation]) -> Self {
        let missing: Vec<f64> = all.iter().map(Innovation::robust_missing).collect();
        let directions: Vec<f64> = all.iter().map(Innovation::direction).collect();
        let n = all.len() as f64;
        let square = |x: &[f64]| dot(x, x);
        let minus = |constant: f64, along: f64| -> Vec<f64> {
            let pairs = missing.iter().zip(&directions);
            pairs.map(|(m, d)| m - constant - along * d).collect()
        };
        let mean = missing.iter().sum::<f64>() / n;
        let along = dot(&missing, &directions) / n;
        let mean_direction = directions.iter().sum::<f64>() / n;
        let spread = 1.0 - mean_direction * mean_direction;
        let remainder = if spread > 0.0 {
            minus(
                (mean - mean_direction * along) / spread,
                (along - mean_direction * mean) / spread,
            )
        } else {
            minus(mean, 0.0)
        };
        let all = square(&missing).max(f64::MIN_POSITIVE);
        let remaining = square(&remainder);
        Self {
            constant: (square(&minus(0.0, along)) - remaining) / all,
            direction: (square(&minus(mean, 0.0)) - remaining) / all,
            remainder_share: remaining / all,
            remainder,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Innovations of alternating directions: three with positive velocity for one with negative velocity.
    fn level(missing: impl Fn(f64) -> f64) -> Decomposition {
        let all: Vec<Innovation> = (0..100)
            .map(|i| {
                let velocity = if i % 4 == 3 { -2.0 } else { 0.7 };
                Innovation {
                    velocity,
                    missing: missing(velocity),
                    ..Innovation::default()
                }
            })
            .collect();
        Decomposition::of(&all)
    }

    #[test]
    fn a_constant_and_friction_are_distinguished() {
        let constant = level(|_| 3.0);
        assert!(constant.direction < 1e-9 && constant.remainder_share < 1e-9);
        assert!((constant.constant - 0.75).abs() < 1e-9, "{constant:?}");
        let friction = level(|v| 3.0 * v.signum());
        assert!(friction.constant < 1e-9 && friction.direction > 0.7);
    }

    #[test]
    fn motion_in_one_direction_gives_no_friction() {
        let all = [Innovation {
            velocity: 1.0,
            missing: 2.0,
            ..Innovation::default()
        }; 5];
        let level = Decomposition::of(&all);
        assert!(level.direction.abs() < 1e-9 && level.remainder_share < 1e-9);
        assert!(level.remainder.iter().all(|r| r.abs() < 1e-9));
    }
}
