//! A torque as a table over one axis, for a missing torque that no effect of the library describes.

use super::axis::Axis;
use super::look::Point;
use host_sim::plant::{Moment, TorqueLaw};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Number of knots of a table.
const KNOTS: usize = 17;
/// Share of the points beyond the outermost knots, on each side.
const BEYOND: f64 = 0.01;
/// Weight of the second differences of the knots, over the weight of all points. It makes the table linear where there are no points.
const STIFFNESS: f64 = 1e-4;

/// The quantity of which a table is a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TableAxis {
    /// Velocity, in position units per s.
    Velocity,
    /// Position, in position units.
    Position,
    /// Input that acts after delay and lag, in input units.
    Input,
}

impl TableAxis {
    /// The table axis for an axis of the missing torque, if a table may have it.
    pub(super) fn of(axis: Axis) -> Option<Self> {
        match axis {
            Axis::Velocity | Axis::VelocityOdd | Axis::VelocityEven => Some(Self::Velocity),
            Axis::Position | Axis::Wave => Some(Self::Position),
            Axis::Input => Some(Self::Input),
            _ => None,
        }
    }

    /// The name of the axis.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::Input => "input",
        }
    }

    fn at(self, moment: &Moment) -> f64 {
        match self {
            Self::Velocity => moment.velocity,
            Self::Position => moment.position,
            Self::Input => moment.input,
        }
    }
}

/// A torque that is linear between knots and constant beyond them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The quantity of which the torque is a function.
    pub axis: TableAxis,
    /// Knots in ascending order.
    pub at: Vec<f64>,
    /// Torque at each knot, N m.
    pub torque: Vec<f64>,
}

impl Table {
    /// The table that fits the missing torque at the points best. Returns `None` if the points do not spread over the axis. `ratio` is
    /// the torque of the drive per unit of input.
    pub(super) fn fitted(axis: TableAxis, points: &[Point], ratio: f64) -> Option<Self> {
        let coordinate = |point: &Point| {
            let moment = Moment {
                position: point.position,
                velocity: point.velocity,
                input: point.drive / ratio,
                time_s: 0.0,
            };
            axis.at(&moment)
        };
        let mut coordinates: Vec<f64> = points.iter().map(coordinate).collect();
        coordinates.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let last = coordinates.len().checked_sub(1)?;
            coordinates.get((last as f64 * share) as usize).copied()
        };
        let (low, high) = (quantile(BEYOND)?, quantile(1.0 - BEYOND)?);
        if high <= low {
            return None;
        }
        let step = (high - low) / (KNOTS - 1) as f64;
        let at: Vec<f64> = (0..KNOTS).map(|k| low + step * k as f64).collect();
        let mut normal = DMatrix::<f64>::zeros(KNOTS, KNOTS);
        let mut right = DVector::<f64>::zeros(KNOTS);
        for point in points {
            let weight = point.std.powi(-2);
            let (knot, part) = between(&at, coordinate(point));
            for (a, of_a) in [(knot, 1.0 - part), (knot + 1, part)] {
                right[a] += weight * of_a * point.torque;
                for (b, of_b) in [(knot, 1.0 - part), (knot + 1, part)] {
                    normal[(a, b)] += weight * of_a * of_b;
                }
            }
        }
        let stiffness = STIFFNESS * normal.trace();
        for knot in 1..KNOTS - 1 {
            let second_difference = [(knot - 1, 1.0), (knot, -2.0), (knot + 1, 1.0)];
            for (a, of_a) in second_difference {
                for (b, of_b) in second_difference {
                    normal[(a, b)] += stiffness * of_a * of_b;
                }
            }
        }
        let torque = normal.cholesky()?.solve(&right);
        let torque: Vec<f64> = torque.iter().copied().collect();
        let is_finite = torque.iter().all(|nm| nm.is_finite());
        is_finite.then_some(Self { axis, at, torque })
    }

    /// True if the knots ascend and each has a finite torque.
    pub(crate) fn is_sound(&self) -> bool {
        let ascends = self.at.windows(2).all(|pair| pair[0] < pair[1]);
        let numbers = self.at.iter().chain(&self.torque);
        self.at.len() >= 2
            && self.at.len() == self.torque.len()
            && ascends
            && numbers.clone().all(|number| number.is_finite())
    }
}

/// Index of the knot below a value, and the share of the distance to the next knot.
fn between(at: &[f64], coordinate: f64) -> (usize, f64) {
    let last = at.len() - 2;
    let knot = at.partition_point(|knot| *knot <= coordinate);
    let knot = knot.saturating_sub(1).min(last);
    let part = (coordinate - at[knot]) / (at[knot + 1] - at[knot]);
    (knot, part.clamp(0.0, 1.0))
}

impl TorqueLaw for Table {
    fn torque_nm(&self, at: &Moment, _parameters: &[f64]) -> f64 {
        let (knot, part) = between(&self.at, self.axis.at(at));
        self.torque[knot] + part * (self.torque[knot + 1] - self.torque[knot])
    }

    fn text(&self) -> String {
        format!("{self:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_follows_its_points_and_is_constant_beyond_them() {
        let points = (0..400).map(|k| {
            let velocity = -2.0 + f64::from(k) * 0.01;
            Point {
                run: 0,
                time_s: 0.0,
                position: 0.0,
                velocity,
                drive: 0.0,
                net: 0.0,
                torque: -0.3 * velocity,
                std: 0.01,
                explained: 0.0,
            }
        });
        let points: Vec<Point> = points.collect();
        let table = Table::fitted(TableAxis::Velocity, &points, 1.0).expect("it spreads");
        assert!(table.is_sound());
        let at = |velocity| {
            let moment = Moment {
                position: 0.0,
                velocity,
                input: 0.0,
                time_s: 0.0,
            };
            table.torque_nm(&moment, &[])
        };
        assert!((at(1.0) + 0.3).abs() < 1e-3, "{}", at(1.0));
        assert_eq!(at(50.0), at(60.0));
        assert_eq!(Table::fitted(TableAxis::Position, &points, 1.0), None);
    }
}
