//! Finds the gains with the smallest cost: a grid search, then a compass search from its best points (R. Hooke and T. A.
//! Jeeves, Journal of the ACM 8, 1961).

use super::gains::Gains;
use rayon::prelude::*;

/// Coordinates of the search, which changes them by equal ratios: proportional gain in N m/°, derivative time in s, and
/// reciprocal integral time in 1/s. Gains without integral action form a separate plane.
type Point = [f64; 3];

const KP: [f64; 2] = [0.005, 0.8];
const DERIVATIVE_S: [f64; 2] = [0.002, 0.1];
const INTEGRAL_PER_S: [f64; 2] = [0.3, 60.0];
/// Number of grid points along each coordinate.
const GRID: [usize; 3] = [11, 8, 4];
/// Number of points of each plane that are refined.
const STARTS: usize = 2;
/// First step ratio and last step ratio of the compass search.
const FIRST_RATIO: f64 = 1.25;
const LAST_RATIO: f64 = 1.01;
/// Smallest relative decrease of the cost for a step to be accepted.
const WORTH_IT: f64 = 1e-4;

fn gains([kp, derivative_s, integral_per_s]: Point) -> Gains {
    Gains {
        kp,
        ki: kp * integral_per_s,
        kd: kp * derivative_s,
    }
}

fn along([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (to / from).powf(1.0 / (count - 1) as f64);
    (0..count).map(move |i| from * ratio.powi(i as i32))
}

/// Finds the gains with the smallest `cost`.
///
/// # Errors
/// Returns an error of `cost`.
pub fn least<E: Send>(cost: impl Fn(&Gains) -> Result<f64, E> + Sync) -> Result<Gains, E> {
    let plane = |rates: &[f64]| {
        let rates = rates.iter().copied();
        let kps = along(KP, GRID[0]);
        let pairs = kps.flat_map(|kp| along(DERIVATIVE_S, GRID[1]).map(move |d| [kp, d]));
        pairs
            .flat_map(|[kp, derivative_s]| rates.clone().map(move |rate| [kp, derivative_s, rate]))
            .collect::<Vec<Point>>()
    };
    let integral: Vec<_> = along(INTEGRAL_PER_S, GRID[2]).collect();
    let mut starts = Vec::new();
    for plane in [plane(&[0.0]), plane(&integral)] {
        let costs = plane
            .par_iter()
            .map(|point| Ok((cost(&gains(*point))?, *point)));
        let mut costs = costs.collect::<Result<Vec<_>, E>>()?;
        costs.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.extend(costs.into_iter().take(STARTS));
    }
    let found = starts.into_par_iter().map(|start| descend(start, &cost));
    let found = found.collect::<Result<Vec<_>, E>>()?;
    let best = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.map_or_else(Gains::default, |(_, point)| gains(point)))
}

/// Moves from `start` until no step along a coordinate reduces the cost.
fn descend<E>(
    start: (f64, Point),
    cost: &impl Fn(&Gains) -> Result<f64, E>,
) -> Result<(f64, Point), E> {
    let (mut least, mut point) = start;
    let mut ratio = FIRST_RATIO;
    while ratio > LAST_RATIO {
        let mut moved = false;
        for axis in 0..point.len() {
            for factor in [ratio, 1.0 / ratio] {
                let mut trial = point;
                trial[axis] *= factor;
                if trial == point {
                    continue;
                }
                let value = cost(&gains(trial))?;
                if value < least * (1.0 - WORTH_IT) {
                    (least, point, moved) = (value, trial, true);
                }
            }
        }
        if !moved {
            ratio = ratio.sqrt();
        }
    }
    Ok((least, point))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn the_minimum_of_a_convex_cost_is_found() {
        let off = |value: f64, at: f64| (value / at).ln().powi(2);
        let bowl = |g: &Gains| {
            Ok::<_, Infallible>(1.0 + off(g.kp, 0.07) + off(g.kd, 0.001) + (g.ki - 0.4).powi(2))
        };
        let Ok(found) = least(bowl);
        assert!((found.kp / 0.07 - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.kd / 0.001 - 1.0).abs() < 0.02 && (found.ki - 0.4).abs() < 0.02);
    }
}
