//! Viscous friction: proportional to the velocity.

use super::identification::{Family, Identification, MainNumber};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::balance::Balance;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::viscous::KIND;

#[derive(Debug)]
pub(super) struct Viscous;

impl Identification for Viscous {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let stated = e.device.mechanics.viscous;
        let scale = 0.1 * e.scales.torque / e.scales.velocity;
        let guess = regress(e, |m| [-m.velocity]);
        let guess = guess.map(|[b]| vec![guessed(0, stated + b, scale)]);
        terms(&KIND, guess, [vec![linear(0, stated, scale)]])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Drag)
    }

    fn main_number(&self) -> Option<MainNumber> {
        Some(MainNumber {
            name: "viscous",
            usual_error: Some(0.3),
        })
    }

    fn balanced(&self, own: &Term, balance: &Balance) -> Term {
        own.starting_at(&[(0, balance.viscous)])
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let stated = path.device.mechanics.viscous;
        let step = 0.1 * path.scale.torque / path.scale.velocity;
        vec![Form::linear(path, &KIND, &[stated], &[(0, step)])]
    }

    fn noun(&self) -> &'static str {
        "viscous friction"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a line over velocity. Quadratic drag is a parabola in each direction, so the two differ only if the speed covers a wide range. Dry friction is a step. Record fast and slow motion."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "viscous friction of {coefficient}"
    }
}
