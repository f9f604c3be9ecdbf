//! What the model misses everywhere alike, and the rest, which some axis may explain.

use super::innovation::Innovation;
use crate::fit::whitening::dot;

/// The missing acceleration, by a robust measure, as a constant, a level along the motion and a rest.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// Share of the square that only a constant explains: a torque that is missing all along.
    pub constant: f64,
    /// Share that only a level along the motion explains: friction.
    pub direction: f64,
    /// What neither explains, one for each innovation.
    pub rest: Vec<f64>,
    /// Its share.
    pub share_of_rest: f64,
}

impl Level {
    pub(super) fn of(all: &[Innovation]) -> Self {
        let missing: Vec<f64> = all.iter().map(Innovation::robust_missing).collect();
        let directions: Vec<f64> = all.iter().map(Innovation::direction).collect();
        let n = all.len() as f64;
        let square = |x: &[f64]| dot(x, x);
        let less = |constant: f64, along: f64| -> Vec<f64> {
            let pairs = missing.iter().zip(&directions);
            pairs.map(|(m, d)| m - constant - along * d).collect()
        };
        let mean = missing.iter().sum::<f64>() / n;
        let along = dot(&missing, &directions) / n;
        let lean = directions.iter().sum::<f64>() / n;
        let spread = 1.0 - lean * lean;
        let rest = if spread > 0.0 {
            less(
                (mean - lean * along) / spread,
                (along - lean * mean) / spread,
            )
        } else {
            less(mean, 0.0)
        };
        let all = square(&missing).max(f64::MIN_POSITIVE);
        let left = square(&rest);
        Self {
            constant: (square(&less(0.0, along)) - left) / all,
            direction: (square(&less(mean, 0.0)) - left) / all,
            share_of_rest: left / all,
            rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Innovations to and fro, three forth for one back.
    fn level(missing: impl Fn(f64) -> f64) -> Level {
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
        Level::of(&all)
    }

    #[test]
    fn a_constant_and_friction_are_told_apart() {
        let constant = level(|_| 3.0);
        assert!(constant.direction < 1e-9 && constant.share_of_rest < 1e-9);
        assert!((constant.constant - 0.75).abs() < 1e-9, "{constant:?}");
        let friction = level(|v| 3.0 * v.signum());
        assert!(friction.constant < 1e-9 && friction.direction > 0.7);
    }

    #[test]
    fn one_direction_alone_is_no_friction() {
        let all = [Innovation {
            velocity: 1.0,
            missing: 2.0,
            ..Innovation::default()
        }; 5];
        let level = Level::of(&all);
        assert!(level.direction.abs() < 1e-9 && level.share_of_rest < 1e-9);
        assert!(level.rest.iter().all(|r| r.abs() < 1e-9));
    }
}
