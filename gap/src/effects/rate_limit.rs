//! A limited rate of change of the acting input.

use super::description::{Demonstration, Multisine};
use super::identification::{Family, Identification};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{geometric, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::rate_limit::KIND;

/// Shortest and longest time in which the limited input changes by the largest input, over the time of one radian of the motion. The
/// shortest time is hardly a limit; with the longest the limit always acts.
const SWING_TIMES: [f64; 2] = [0.1, 10.0];
const STARTS: usize = 6;

#[derive(Debug)]
pub(super) struct RateLimit;

impl Identification for RateLimit {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let input = e.largest_input();
        let rate = 2.0 * e.scales.velocity / e.scales.span();
        rates(input, rate)
            .map(|rate| term(&KIND, vec![log(0, rate)], &[]))
            .collect()
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Lateness)
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let limits = rates(path.scale.input, path.scale.rate());
        let forms = limits.map(|limit| Form::whole(path, &KIND, vec![limit], None).positive());
        target.screened(forms.collect(), 1)
    }

    fn noun(&self) -> &'static str {
        "a limited rate of the input"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque is late where the input changes fast, whatever its size. A lag delays slow changes too. A saturation goes with the size of the input. Record steps of several heights: under a rate limit the delay grows with the height."
    }

    /// The experiment has no controller, because a controller would react to the delayed torque with more torque, and the oscillation
    /// would grow.
    fn demonstration(&self) -> Demonstration {
        Demonstration {
            multisine: Multisine::Torque {
                amplitude_nm: 0.006,
                frequency_hz: 2.0,
            },
            numbers: &[],
        }
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "an input that acts no faster than {rate}"
    }
}

/// Rate limits that may affect a motion of angular frequency `rate`, rad/s, in input units per s.
fn rates(input: f64, rate: f64) -> impl Iterator<Item = f64> {
    geometric(SWING_TIMES, STARTS).map(move |swing| (input * rate / swing).max(f64::MIN_POSITIVE))
}
