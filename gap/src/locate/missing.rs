//! The axis of which the missing torque is a function.

use super::bins::{Bins, Point};
use super::evidence::{BINS, Evidence};
use crate::diagnosis::MeasuredBy;
use crate::missing_torque::{self, Axis, MissingTorque};
use host_sim::device::Device;
use recording::{Model, Recording};

/// Least share of the squared missing torque that a function of one axis must explain on held-out data. Such an axis is reported first.
const LEAST_SHARE: f64 = 0.5;

/// The axis of which a function explains most of the missing torque, with the stretch whose share of the squared torque exceeds its share
/// of the samples most. Returns `None` if no axis explains [`LEAST_SHARE`], or if the missing torque repeats.
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
    let instants = missing.points();
    // A block of the resampling is one horizon of one run.
    let horizon_of =
        |point: &missing_torque::Point| (point.time_s / recording.horizon).max(0.0) as usize;
    let longest = instants.iter().map(horizon_of).max()? + 1;
    let points = instants.iter().enumerate().map(|(index, point)| Point {
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

/// Computes a coordinate from one instant of the missing torque and the nominal model.
type Column = fn(&missing_torque::Point, &Model) -> f64;

/// Name and coordinate of an axis of the missing torque. Returns `None` for an axis without a coordinate on the motion.
fn column(axis: Axis) -> Option<(&'static str, Column)> {
    match axis {
        Axis::Velocity | Axis::VelocityOdd | Axis::VelocityEven => {
            Some(("velocity", |p, _| p.velocity))
        }
        Axis::Position | Axis::DirectionAndPosition => Some(("position", |p, _| p.position)),
        Axis::Input => Some(("input", |p, model| p.drive / model.ratio)),
        // The acceleration by the nominal torque is used, because the measured one contains the missing torque.
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
    fn a_missing_torque_is_located_on_the_axis_of_which_it_is_a_function() {
        assert_eq!(axis(&["spring:stiffness=0.06,zero=0"]), Some("position"));
        assert_eq!(axis(&["quadratic_drag:coefficient=6e-4"]), Some("velocity"));
        assert_eq!(axis(&["inertia:inertia=9e-4"]), Some("acceleration"));
    }

    #[test]
    fn noise_is_located_on_no_axis() {
        assert_eq!(axis(&[]), None);
    }
}
