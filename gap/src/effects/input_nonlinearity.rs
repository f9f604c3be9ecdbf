//! A nonlinear characteristic from input to torque.

use super::deadband::Deadband;
use super::description::Demonstration;
use super::identification::Identification;
use super::phrase::Found;
use super::saturation::Saturation;
use super::torque_gain::TorqueGain;
use crate::guess::Evidence;
use crate::guess::start::{linear, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::input_nonlinearity::KIND;

/// Indices of the parameters.
const GAIN: usize = 0;
const POWER: usize = 1;
const DEAD_ZONE: usize = 2;
const REFERENCE: usize = 3;
const KNEE: usize = 4;
const SLOPE_BEYOND: usize = 5;
/// Starts of the power and of the dead zone, the latter over the reference input.
const STARTS: [(f64, f64); 4] = [(0.6, 0.0), (1.6, 0.0), (0.6, 0.1), (1.2, 0.1)];
/// Starts of the slope beyond a knee in the middle of the inputs.
const SLOPES: [f64; 2] = [0.4, 2.5];
/// Start of the knee over the reference input, and one unit of its coordinate.
const MIDDLE: f64 = 0.5;
const KNEE_UNIT: f64 = 0.15;
/// Quantile of the inputs that is the reference. The few largest inputs then do not set the gain of all others.
const LARGE: f64 = 0.9;
/// Powers that are screened for the missing torque, and reference inputs over the largest input.
const POWERS_SCREENED: [f64; 4] = [0.4, 0.7, 1.5, 2.2];
const REFERENCES_SCREENED: [f64; 2] = [0.5, 0.9];
/// One unit of the coordinate of the dead zone, over the reference input.
const ZONE: f64 = 0.05;

#[derive(Debug)]
pub(super) struct InputNonlinearity;

impl Identification for InputNonlinearity {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let inputs = e.series.iter().flat_map(|series| &series.input);
        let sizes: Vec<f64> = inputs.map(|u| e.device.drive.taken(*u)).collect();
        let reference = quantile(&sizes, LARGE);
        if reference <= 0.0 {
            return Vec::new();
        }
        let starts = STARTS.map(|(power, zone)| {
            let mut free = vec![log(GAIN, 1.0), log(POWER, power)];
            if zone > 0.0 {
                free.push(dead_zone(zone * reference, reference));
            }
            term(&KIND, free, &[(REFERENCE, reference)])
        });
        let bent = SLOPES.map(|slope| {
            let knee = linear(KNEE, MIDDLE * reference, KNEE_UNIT * reference);
            let free = vec![log(GAIN, 1.0), knee, log(SLOPE_BEYOND, slope)];
            term(&KIND, free, &[(REFERENCE, reference)])
        });
        starts.into_iter().chain(bent).collect()
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        let zone = (!fitted.is_free(DEAD_ZONE)).then(|| dead_zone(0.0, fitted.values[REFERENCE]));
        zone.into_iter().collect()
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueGain, &Deadband, &Saturation]
    }

    fn axis(&self) -> Axis {
        Axis::Input
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let form = |set: &[(usize, f64)]| {
            Form::whole(path, &KIND, with_defaults(&KIND, set), None).positive()
        };
        let references = REFERENCES_SCREENED.map(|part| part * path.scale.input);
        let powers = POWERS_SCREENED.iter().flat_map(|&power| {
            references.map(|reference| form(&[(GAIN, 1.0), (POWER, power), (REFERENCE, reference)]))
        });
        let bent = SLOPES.iter().flat_map(|&slope| {
            references.map(|reference| {
                let knee = MIDDLE * reference;
                form(&[
                    (GAIN, 1.0),
                    (REFERENCE, reference),
                    (KNEE, knee),
                    (SLOPE_BEYOND, slope),
                ])
            })
        });
        target.screened(powers.chain(bent).collect(), 2)
    }

    fn noun(&self) -> &'static str {
        "a torque that is a curve of the input"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a curve over the input and not a line. A torque gain is a line, a dead band two lines, a saturation a line with a bend. Only inputs over the whole range tell the curves apart."
    }

    fn demonstration(&self) -> Demonstration {
        Demonstration {
            numbers: &[("power", 0.6)],
            ..Demonstration::USUAL
        }
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match (found.fitted("slope_beyond"), found.fitted("dead_zone")) {
            (Some(_), _) => {
                "a torque whose slope over the input is {slope_beyond} times as steep beyond {knee}"
            }
            (None, Some(_)) => {
                "a torque that goes with the power {power} of the input beyond a dead zone of {dead_zone}"
            }
            (None, None) => "a torque that goes with the power {power} of the input",
        }
    }
}

fn dead_zone(start: f64, reference: f64) -> Coordinate {
    linear(DEAD_ZONE, start, ZONE * reference)
}
