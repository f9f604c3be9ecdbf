//! A sensor with a different gain.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use crate::columns::Disagreement;
use crate::guess::Evidence;
use crate::guess::start::{linear, log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::misreading::{STEP, misread};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::sensor_gain::KIND;
use host_sim::plant::Mechanics;
use recording::Model;

/// Typical distance from the middle of the motion to the position at which the sensor reads correctly, over the range of the motion.
const CORRECT_AT: f64 = 0.2;

#[derive(Debug)]
pub(super) struct SensorGain;

impl Identification for SensorGain {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let about_zero = vec![log(0, 1.0)];
        let about_other_position = vec![log(0, 1.0), linear(1, s.middle(), CORRECT_AT * s.span())];
        let about_other_position =
            depends_on_position(&e.device.mechanics).then_some(about_other_position);
        terms(&KIND, about_other_position, [about_zero])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Size)
    }

    fn on_small_motion(&self, fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        let ratio = fitted.values[0];
        Some(SmallMotion::Size { ratio })
    }

    fn equivalent_start(&self, own: &Term, other: SmallMotion, _model: &Model) -> Option<Term> {
        let SmallMotion::Size { ratio } = other else {
            return None;
        };
        (ratio > 0.0 && ratio.is_finite()).then(|| own.starting_at(&[(0, ratio)]))
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let line = columns.linear(|x| [x, 1.0]);
        let values = line.map(|[slope, _]| vec![1.0 + slope, 0.0]);
        values.into_iter().collect()
    }

    fn axis(&self) -> Axis {
        Axis::Input
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let gain = misread(path, |x| [STEP * x, STEP, 0.0]);
        let alone = Form::new(vec![gain.clone()], |c| {
            with_defaults(&KIND, &[(0, (1.0 + STEP * c[0]).max(0.1))])
        });
        if !path.device.mechanics.is_pulled() {
            return vec![alone];
        }
        // The position at which the sensor reads correctly may differ from zero.
        let half = path.scale.half_span();
        let shift = misread(path, |_| [STEP * half, 0.0, 0.0]);
        let about_other_position = Form::new(vec![gain, shift], move |c| {
            let correct_at = if c[0] == 0.0 {
                0.0
            } else {
                -c[1] * half / c[0]
            };
            let values = [(0, (1.0 + STEP * c[0]).max(0.1)), (1, correct_at)];
            with_defaults(&KIND, &values)
        });
        vec![alone, about_other_position]
    }

    fn noun(&self) -> &'static str {
        "another sensor gain"
    }

    fn tell_apart(&self) -> &'static str {
        "All motion is read larger or smaller, also motion that the input does not cause. A torque gain scales the cause and not the reading. A second sensor of the same position decides."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a sensor that shows {gain} times the way gone"
    }
}

/// True if the dynamics of the device depend on its position.
fn depends_on_position(mechanics: &Mechanics) -> bool {
    let has_stops = mechanics.barriers.iter().any(Option::is_some);
    mechanics.is_pulled() || mechanics.cogging.is_some() || has_stops
}
