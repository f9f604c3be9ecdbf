//! Drag proportional to the square of the speed.

use super::identification::{Family, Identification};
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
use host_sim::effects::quadratic_drag::KIND;

#[derive(Debug)]
pub(super) struct QuadraticDrag;

impl Identification for QuadraticDrag {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let scale = 0.1 * e.scales.torque / e.scales.velocity.powi(2);
        let guess = regress(e, |m| [-m.velocity * m.velocity.abs()]);
        let guess = guess.map(|[q]| vec![guessed(0, q.max(0.0), scale)]);
        terms(&KIND, guess, [vec![linear(0, 0.0, scale)]])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Drag)
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let stated = path.device.mechanics.drag;
        let step = 0.1 * path.scale.torque / path.scale.velocity.powi(2);
        vec![Form::linear(path, &KIND, &[stated], &[(0, step)])]
    }

    fn noun(&self) -> &'static str {
        "quadratic drag"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque grows with the square of the speed. Viscous friction is a line. Record motion that is at least three times as fast as the slowest."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "drag of {coefficient} times the square of the speed"
    }
}
