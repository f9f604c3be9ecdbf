//! A constant torque.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::torque_offset::KIND;
use recording::Model;

#[derive(Debug)]
pub(super) struct TorqueOffset;

impl Identification for TorqueOffset {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let guess = regress(e, |_| [1.0]).map(|[t]| vec![guessed(0, t, 0.2 * s.torque)]);
        let offset = |f: f64| vec![linear(0, f * s.friction, 0.2 * s.torque)];
        terms(&KIND, guess, [0.3, -0.3].map(offset))
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Push)
    }

    fn on_small_motion(&self, fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        let torque_nm = fitted.values[0];
        Some(SmallMotion::Push { torque_nm })
    }

    fn replaces(&self) -> Option<&'static str> {
        Some("offset")
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let offset = path.device.mechanics.offset_nm;
        let step = path.scale.torque_step();
        vec![Form::linear(path, &KIND, &[offset], &[(0, step)])]
    }

    fn noun(&self) -> &'static str {
        "a constant torque"
    }

    fn tell_apart(&self) -> &'static str {
        "A constant torque has one sign in both directions, dry friction turns with the motion. Friction that depends on the direction is an offset while the joint slides, but it holds less than an offset pushes when the joint rests. Record some rest with no input."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a constant torque of {torque}"
    }
}
