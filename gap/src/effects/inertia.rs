//! Another inertia.

use super::identification::{Family, Identification, MainNumber, SmallMotion};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::balance::Balance;
use crate::guess::regression::regress;
use crate::guess::start::{log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::inertia::KIND;
use recording::Model;

#[derive(Debug)]
pub(super) struct Inertia;

impl Identification for Inertia {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let stated = e.device.mechanics.inertia;
        let guess = regress(e, |m| [-m.acceleration]);
        let guess = guess.map(|[j]| vec![log(0, (stated + j).max(0.1 * stated))]);
        terms(&KIND, guess, [vec![log(0, stated)]])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Size)
    }

    fn on_small_motion(&self, fitted: &Term, model: &Model) -> Option<SmallMotion> {
        let ratio = model.inertia / fitted.values[0];
        Some(SmallMotion::Size { ratio })
    }

    fn equivalent_start(&self, own: &Term, other: SmallMotion, model: &Model) -> Option<Term> {
        let SmallMotion::Size { ratio } = other else {
            return None;
        };
        let inertia = model.inertia / ratio;
        (inertia > 0.0 && inertia.is_finite()).then(|| own.starting_at(&[(0, inertia)]))
    }

    fn main_number(&self) -> Option<MainNumber> {
        Some(MainNumber {
            name: "inertia",
            usual_error: Some(0.05),
        })
    }

    fn balanced(&self, own: &Term, balance: &Balance) -> Term {
        own.starting_at(&[(0, balance.inertia)])
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        // From J' a = T follows J a − T = (J/J' − 1) T.
        let stated = path.device.mechanics.inertia;
        let column = path.torque(path.device);
        vec![Form::new(vec![column], move |c| {
            vec![stated / (1.0 + c[0]).max(0.05)]
        })]
    }

    fn noun(&self) -> &'static str {
        "another inertia"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a line over the torque that accelerates. A torque gain scales all torque of the drive, also while nothing accelerates. Record fast motion, and some slow motion against gravity or friction."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "an inertia of {inertia}"
    }
}
