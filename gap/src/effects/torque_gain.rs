//! A drive with a different gain.

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
use host_sim::effects::torque_gain::KIND;
use recording::Model;

#[derive(Debug)]
pub(super) struct TorqueGain;

impl Identification for TorqueGain {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let as_known = e.device.drive.ratio / e.model.ratio;
        let guess = regress(e, |m| [m.drive_nm]);
        let guess = guess.map(|[g]| vec![log(0, as_known * (1.0 + g).max(0.05))]);
        terms(&KIND, guess, [vec![log(0, as_known)]])
    }

    fn sets_in_model(&self) -> Option<&'static str> {
        // The gain multiplies the stated ratio, so both must not be free.
        Some("ratio")
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

    fn main_number(&self) -> Option<MainNumber> {
        Some(MainNumber {
            name: "ratio",
            usual_error: None,
        })
    }

    fn balanced(&self, own: &Term, balance: &Balance) -> Term {
        own.starting_at(&[(0, balance.gain)])
    }

    fn axis(&self) -> Axis {
        Axis::Input
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        vec![Form::linear(path, &KIND, &[1.0], &[(0, 0.3)])]
    }

    fn noun(&self) -> &'static str {
        "another torque gain"
    }

    fn tell_apart(&self) -> &'static str {
        "A gain scales the drive alone. Inertia scales the acceleration and leaves friction and gravity as they are, so the two differ where friction or gravity carries much of the torque. A sensor gain also scales what is read while nothing drives. Record slow motion under gravity and fast motion."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a torque of {gain} times the commanded one"
    }
}
