//! Coulomb friction that increases with the load.

use super::identification::Identification;
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{linear, log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use host_sim::effects::Kind;
use host_sim::effects::load_dependent_friction::KIND;

/// Starts of the parameter `passive`.
const PASSIVE_STARTS: [f64; 3] = [1.0, -1.0, 10.0];
/// Values of `passive` that are screened for the missing torque.
const PASSIVE_SCREENED: [f64; 3] = [0.0, 1.0, -1.0];
/// Indices of the parameters `share` and `backdriven_extra`.
const SHARE: usize = 0;
const EXTRA: usize = 2;
/// Starts of `share` and `backdriven_extra` if both are free: a gear that rubs mostly where the motor drives, one that rubs more where the
/// load drives, and one that rubs only there.
const SIDED_STARTS: [[f64; 2]; 3] = [[0.15, -0.1], [0.05, 0.15], [0.0, 0.5]];
/// Change of a share per unit of its coordinate.
const SHARE_SCALE: f64 = 0.1;

#[derive(Debug)]
pub(super) struct LoadDependentFriction;

impl Identification for LoadDependentFriction {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let guess = regress(e, |m| [-m.drive_nm.abs() * m.velocity.signum()]);
        let guess = guess.map(|[share]| vec![log(SHARE, share.max(0.01))]);
        let mut starts = terms(
            &KIND,
            guess,
            [0.05, 0.2].map(|share| vec![log(SHARE, share)]),
        );
        if e.device.mechanics.is_pulled() {
            let carried = PASSIVE_STARTS.map(|part| vec![log(SHARE, 0.1), linear(1, part, 1.0)]);
            starts.extend(terms(&KIND, None, carried));
        }
        let sided = SIDED_STARTS.map(|[share, extra]| {
            let of = |place, start| linear(place, start, SHARE_SCALE);
            vec![of(SHARE, share), of(EXTRA, extra)]
        });
        starts.extend(terms(&KIND, None, sided));
        starts
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        let extra = (!fitted.is_free(EXTRA)).then(|| linear(EXTRA, 0.0, SHARE_SCALE));
        extra.into_iter().collect()
    }

    fn axis(&self) -> Axis {
        Axis::Load
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let pulled = path.device.mechanics.is_pulled();
        let parts = PASSIVE_SCREENED.iter();
        let parts = parts.filter(|part| pulled || **part == 0.0);
        let sides: [&[(usize, f64)]; 3] = [
            &[(SHARE, SHARE_SCALE)],
            &[(EXTRA, SHARE_SCALE)],
            &[(SHARE, SHARE_SCALE), (EXTRA, SHARE_SCALE)],
        ];
        let forms = parts.flat_map(|&part| {
            let base = [0.0, part, 0.0];
            sides.map(|side| Form::linear(path, &KIND, &base, side).positive())
        });
        forms.collect()
    }

    fn noun(&self) -> &'static str {
        "dry friction that grows with the load"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque against the motion grows with the transmitted torque. It is larger or smaller where the load drives the motor. Another level of dry friction does not depend on the load. Record with two loads, or with a pendulum that swings."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.fitted("passive") {
            None if found.fitted("backdriven_extra").is_some() => {
                "dry friction that grows by {share} of the driving torque, and by {backdriven_extra} of it more where the load drives"
            }
            Some(_) => {
                "dry friction that grows by {share} of what the drive and {passive} times the weight or spring pull together"
            }
            None => "dry friction that grows by {share} of the driving torque",
        }
    }
}
