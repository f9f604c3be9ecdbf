//! Coulomb friction with different levels in the two directions.

use super::coulomb::Coulomb;
use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::asymmetric_coulomb::KIND;
use recording::Model;

#[derive(Debug)]
pub(super) struct AsymmetricCoulomb;

impl Identification for AsymmetricCoulomb {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let level = e.device.mechanics.friction.level_nm;
        let guess = regress(e, |m| {
            let forward = f64::from(m.velocity > 0.0);
            [-forward, 1.0 - forward]
        });
        let both = |[forward, backward]: [f64; 2]| vec![log(0, forward), log(1, backward)];
        let least = 0.05 * s.friction;
        let guess =
            guess.map(|[p, n]| both([(level[0] + p).max(least), (level[1] + n).max(least)]));
        let tried = [[0.7, 1.3], [1.3, 0.7]];
        terms(
            &KIND,
            guess,
            tried.map(|pair| both(pair.map(|f| f * s.friction))),
        )
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&Coulomb]
    }

    fn simpler_substitutes(&self) -> &'static [&'static dyn Identification] {
        // During sliding a constant torque acts like less friction in one direction and more in the other.
        &[&TorqueOffset]
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Push)
    }

    fn equivalent_start(&self, own: &Term, other: SmallMotion, model: &Model) -> Option<Term> {
        let SmallMotion::Push { torque_nm } = other else {
            return None;
        };
        // A positive torque acts like less friction in the positive direction and more in the negative one.
        let levels = [-1.0, 1.0].map(|way| model.coulomb + way * torque_nm);
        let is_friction = levels.iter().all(|level| *level > 0.0);
        is_friction.then(|| own.starting_at(&[(0, levels[0]), (1, levels[1])]))
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let base = path.device.mechanics.friction.level_nm;
        let step = path.scale.torque_step();
        [&[(0, step)][..], &[(1, step)], &[(0, step), (1, step)]]
            .map(|steps| Form::linear(path, &KIND, &base, steps))
            .into()
    }

    fn noun(&self) -> &'static str {
        "dry friction that depends on the direction"
    }

    fn tell_apart(&self) -> &'static str {
        "The step at a reversal is not centred on zero. A constant torque beside dry friction does the same while the joint slides; at rest they differ. Record some rest with no input."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "dry friction of {positive} against positive and {negative} against negative motion"
    }
}
