//! The axis that the missing torque is a function of.

use super::bins::{Bins, Point};
use super::evidence::{BINS, Evidence};
use crate::diagnosis::MeasuredBy;
use crate::missing_torque::{self, Axis, MissingTorque};
use host_sim::device::Device;
use recording::{Model, Recording};

/// Least share of the squared missing torque that a function of one axis must explain on held-out time for that axis to come first: most
/// of it.
const LEAST_SHARE: f64 = 0.5;

/// The axis of which a function explains most of the missing torque, if there is one, with the stretch of it whose share of the squared
/// torque exceeds its share of the samples most.
pub(super) fn missing(recording: &Recording) -> Option<Evidence> {
    let missing = MissingTorque::of(recording, &Device::nominal(&recording.model));
    let summary = missing.summary();
    if summary.repeats {
        return None;
    }
    let shares = summary
        .shares
        .iter()
        .filter(|share| share.share >= LEAST_SHARE);
    let (axis, at) = shares.filter_map(|share| column(share.axis)).next()?;
    let seen = missing.points();
    // Whole horizons are drawn, of each run its own.
    let horizon_of =
        |point: &missing_torque::Point| (point.time_s / recording.horizon).max(0.0) as usize;
    let longest = seen.iter().map(horizon_of).max()? + 1;
    let points = seen.iter().enumerate().map(|(index, point)| Point {
        at: at(point, &recording.model),
        index,
        block: point.run * longest + horizon_of(point),
        weight: 1.0,
        excess: (point.torque.powi(2) - point.std.powi(2)).max(0.0),
    });
    let points = points.collect();
    let bins = Bins::new(points, BINS)?;
    let stretch = bins.best(None)?;
    Some(Evidence {
        measured_by: MeasuredBy::MissingTorque,
        ..Evidence::new(axis, bins, stretch, stretch.surplus())
    })
}

/// A value at an instant of the missing torque of a nominal model.
type Column = fn(&missing_torque::Point, &Model) -> f64;

/// The axis of a place that a share is about, with its values; none of what is no place.
fn column(axis: Axis) -> Option<(&'static str, Column)> {
    match axis {
        Axis::Velocity | Axis::VelocityOdd | Axis::VelocityEven => {
            Some(("velocity", |p, _| p.velocity))
        }
        Axis::Position | Axis::DirectionAndPosition => Some(("position", |p, _| p.position)),
        Axis::Input => Some(("input", |p, model| p.drive / model.ratio)),
        // By the nominal torque: the measured acceleration holds what is missing.
        Axis::Acceleration => Some(("acceleration", |p, model| p.net / model.inertia)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    fn axis(effects: &[&str]) -> Option<&'static str> {
        missing(&made::recording(effects)).map(|evidence| evidence.axis)
    }

    #[test]
    fn a_missing_torque_lies_on_the_axis_that_it_is_a_function_of() {
        assert_eq!(axis(&["spring:stiffness=0.06,zero=0"]), Some("position"));
        assert_eq!(axis(&["quadratic_drag:coefficient=6e-4"]), Some("velocity"));
        assert_eq!(axis(&["inertia:inertia=9e-4"]), Some("acceleration"));
    }

    #[test]
    fn noise_lies_on_no_axis() {
        assert_eq!(axis(&[]), None);
    }
}
