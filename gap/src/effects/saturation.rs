//! Saturation: the input is limited.

use super::description::{Demonstration, Multisine};
use super::identification::Identification;
use super::phrase::{Found, Phrase};
use crate::guess::Evidence;
use crate::guess::start::{log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::saturation::KIND;

/// Start of the knee of a gradual saturation.
const KNEE: f64 = 0.5;
/// Index of the parameter `no_load`, its starts over the highest speed, and the quantile of the speeds that counts as the highest.
const NO_LOAD_SPEED: usize = 2;
const NO_LOAD: [f64; 2] = [1.2, 3.0];
const FASTEST: f64 = 0.99;
/// Starts of a limit above that of the model: shares of the distance from the limit of the model to the largest input. The first one limits
/// no recorded input. A higher limit would predict the same, and claim more than the recording shows.
const RAISED_SHARES: [f64; 3] = [1.0, 0.3, 0.9];
/// Limits that are screened for the missing torque, over the largest input, and over the limit of the model if that one may be too low.
const LOWER_SCREENED: [f64; 8] = [0.92, 0.84, 0.76, 0.67, 0.58, 0.49, 0.4, 0.3];
const HIGHER_SCREENED: [f64; 3] = [1.15, 1.5, 2.2];

#[derive(Debug)]
pub(super) struct Saturation;

impl Identification for Saturation {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let inputs = e.series.iter().flat_map(|s| &s.input);
        // The drive of the model limits the input, so inputs beyond its limit do not show another limit.
        let inputs: Vec<f64> = inputs.map(|u| e.device.drive.taken(*u)).collect();
        // Limits that affect only the largest input, a few inputs, or many.
        let limits = [1.0, 0.99, 0.95, 0.8, 0.5].map(|share| quantile(&inputs, share));
        let limits = limits.map(|limit| log(0, 0.9 * limit.max(0.1 * e.scales.input)));
        let clipped = limits.map(|limit| term(&KIND, vec![limit], &[(1, 0.0)]));
        let rounded = limits.map(|limit| term(&KIND, vec![limit, log(1, KNEE)], &[]));
        let speed_dependent = speed_dependent(e, &limits);
        let lower = clipped.into_iter().chain(rounded).chain(speed_dependent);
        lower.chain(raised_limits(e)).collect()
    }

    fn may_show_in_few_windows(&self) -> bool {
        true
    }

    fn axis(&self) -> Axis {
        Axis::Input
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let limit = path.device.drive.limit;
        let reached = path.scale.input.min(limit);
        let lower = LOWER_SCREENED.iter().map(|part| part * reached);
        let higher = HIGHER_SCREENED.iter().map(|part| part * limit);
        let higher = higher.filter(|_| limit < path.scale.input);
        let forms = lower.chain(higher).flat_map(|limit| {
            [0.0, 0.5].map(|knee| {
                let values = with_defaults(&KIND, &[(0, limit), (1, knee), (2, 0.0)]);
                Form::whole(path, &KIND, values, None).positive()
            })
        });
        target.screened(forms.collect(), 2)
    }

    fn noun(&self) -> &'static str {
        "saturation"
    }

    fn tell_apart(&self) -> &'static str {
        "Nothing lacks below the limit. A torque gain lacks in proportion at all inputs. Record one run with small and one with large inputs."
    }

    fn demonstration(&self) -> Demonstration {
        Demonstration {
            multisine: Multisine::Torque {
                amplitude_nm: 0.006,
                frequency_hz: 2.0,
            },
            numbers: &[("limit", 0.003)],
        }
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.fitted("no_load") {
            Some(_) => "an input that saturates at {limit} at rest, and at nothing at {no_load}",
            None => "an input that saturates at {limit}",
        }
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        let stated = found.nominal.input_limit;
        let is_raised = stated.is_some() && found.value("limit") > stated;
        if is_raised && found.fitted("limit").is_none() {
            return Phrase::of("an input that is not clipped where the model clips it");
        }
        self.filled_template(found)
    }
}

/// Limits of a drive with limited voltage, which decrease with speed.
fn speed_dependent(e: &Evidence<'_>, limits: &[Coordinate]) -> Vec<Term> {
    let speeds = e.motions.iter().flat_map(|m| &m.velocity).map(|v| v.abs());
    let fastest = quantile(&speeds.collect::<Vec<f64>>(), FASTEST);
    let no_load = NO_LOAD.map(|f| log(NO_LOAD_SPEED, f * fastest));
    let speed_dependent = limits
        .iter()
        .flat_map(|limit| no_load.map(|no_load| term(&KIND, vec![*limit, no_load], &[(1, 0.0)])));
    speed_dependent.collect()
}

/// Limits above that of the model, if the limit of the model affects the commanded input.
fn raised_limits(e: &Evidence<'_>) -> Vec<Term> {
    let largest = e.largest_input();
    let limit = e.device.drive.taken(largest);
    let raised_limits = RAISED_SHARES.map(|share| limit + share * (largest - limit));
    raised_limits
        .into_iter()
        .filter(|_| e.clips_input())
        .map(|limit| term(&KIND, vec![log(0, limit)], &[(1, 0.0)]))
        .collect()
}
