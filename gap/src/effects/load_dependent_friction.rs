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
/// Index of the parameter `backdriven`, and its starts.
const BACKDRIVEN: usize = 2;
const BACKDRIVEN_STARTS: [f64; 2] = [0.3, 4.0];
/// Values of `backdriven` that are screened for the missing torque.
const BACKDRIVEN_SCREENED: [f64; 2] = [1.0, 5.0];

#[derive(Debug)]
pub(super) struct LoadDependentFriction;

impl Identification for LoadDependentFriction {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let guess = regress(e, |m| [-m.drive_nm.abs() * m.velocity.signum()]);
        let guess = guess.map(|[share]| vec![log(0, share.max(0.01))]);
        let mut starts = terms(&KIND, guess, [0.05, 0.2].map(|share| vec![log(0, share)]));
        if e.device.mechanics.is_pulled() {
            let carried = PASSIVE_STARTS.map(|part| vec![log(0, 0.1), linear(1, part, 1.0)]);
            starts.extend(terms(&KIND, None, carried));
        }
        let backdriven = BACKDRIVEN_STARTS.map(|factor| vec![log(0, 0.1), log(BACKDRIVEN, factor)]);
        starts.extend(terms(&KIND, None, backdriven));
        starts
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        let backdriven = (!fitted.is_free(BACKDRIVEN)).then(|| log(BACKDRIVEN, 1.0));
        backdriven.into_iter().collect()
    }

    fn axis(&self) -> Axis {
        Axis::Load
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let pulled = path.device.mechanics.is_pulled();
        let parts = PASSIVE_SCREENED.iter();
        let parts = parts.filter(|part| pulled || **part == 0.0);
        let forms = parts.flat_map(|&part| {
            BACKDRIVEN_SCREENED.map(|factor| {
                Form::linear(path, &KIND, &[0.0, part, factor], &[(0, 0.1)]).positive()
            })
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
            None if found.fitted("backdriven").is_some() => {
                "dry friction that grows by {share} of the driving torque, and by {backdriven} times as much where the load drives"
            }
            Some(_) => {
                "dry friction that grows by {share} of what the drive and {passive} times the weight or spring pull together"
            }
            None => "dry friction that grows by {share} of the driving torque",
        }
    }
}
