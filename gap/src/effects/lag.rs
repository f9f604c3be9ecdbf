//! A lag of the drive: the torque follows the input with a first-order lag.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::{Found, Part, Phrase};
use crate::guess::Evidence;
use crate::guess::delays::{longer_times, shorter_time, two_equal_lags};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::delay_forms::{DELAYS, delay_form};
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::lag::KIND;
use recording::Model;

/// Indices of the parameters `apart` and `twice`.
const APART: usize = 1;
const TWICE: usize = 2;

#[derive(Debug)]
pub(super) struct Lag;

impl Identification for Lag {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        [longer_lags(e), shorter_time(&KIND, e.model.lag)].concat()
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Lateness)
    }

    fn equivalent_start(&self, own: &Term, other: SmallMotion, model: &Model) -> Option<Term> {
        let SmallMotion::LateReading { time_s } = other else {
            return None;
        };
        // If the model has a lag, a lag of the sensor acts like a second lag of the drive.
        (model.lag > 0.0).then(|| in_series(&own.starting_at(&[(0, time_s)])))
    }

    fn replaces(&self) -> Option<&'static str> {
        Some("lag")
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let stated_s = path.device.drive.lag_s;
        let mut forms: Vec<Form> = delay_form(path, target, &KIND, stated_s)
            .into_iter()
            .collect();
        if stated_s == 0.0 {
            let twice = DELAYS.iter().map(|part| {
                let values = with_defaults(&KIND, &[(0, part / path.scale.rate()), (1, 1.0)]);
                Form::whole(path, &KIND, values, Some(0)).positive()
            });
            forms.extend(target.screened(twice.collect(), 1));
        }
        forms
    }

    fn noun(&self) -> &'static str {
        "lag of the torque"
    }

    fn tell_apart(&self) -> &'static str {
        "A lag delays fast inputs less than slow ones and makes them smaller; a delay shifts all alike. A sensor's lag also delays motion that the input does not cause, such as a fall from rest. Record a chirp or steps."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.value("twice") {
            Some(1.0) => "a torque that lags by {time}, and by as much again",
            _ => "a torque that lags by {time}",
        }
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        if let Some(less) = found.shortened_by("time") {
            return Phrase(vec![
                Part::Words("a torque that lags by ".into()),
                Part::Number(less),
                Part::Words(" less than the model has it".into()),
            ]);
        }
        self.filled_template(found)
    }
}

/// A longer lag than that of the model, a second lag in series with it, or two equal lags.
fn longer_lags(e: &Evidence<'_>) -> Vec<Term> {
    let longer_lags = longer_times(&KIND, e);
    let has_one = e.device.drive.lag_s > 0.0;
    let behind: Vec<Term> = longer_lags
        .iter()
        .filter(|_| has_one)
        .map(in_series)
        .collect();
    let both = two_equal_lags(&longer_lags, TWICE);
    [longer_lags, behind, both].concat()
}

/// The lag in series with that of the model.
fn in_series(lag: &Term) -> Term {
    lag.starting_at(&[(APART, 1.0)])
}
