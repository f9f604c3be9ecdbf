//! A dead time of the drive: the torque follows the input after a delay.

use super::identification::{Family, Identification};
use super::phrase::{Found, Part, Phrase};
use super::sensor_lag::SensorLag;
use crate::guess::Evidence;
use crate::guess::delays::{longer_times, shorter_time};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::delay_forms::delay_form;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::delay::KIND;

#[derive(Debug)]
pub(super) struct Delay;

impl Identification for Delay {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        [longer_times(&KIND, e), shorter_time(&KIND, e.model.delay)].concat()
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Lateness)
    }

    fn indistinguishable(&self, fitted: &Term) -> &'static [&'static dyn Identification] {
        // A delayed reading cannot be distinguished from a delayed drive.
        match fitted.values[0] > 0.0 {
            true => &[&SensorLag],
            false => &[],
        }
    }

    fn replaces(&self) -> Option<&'static str> {
        Some("delay")
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let stated_s = path.device.drive.delay_s;
        delay_form(path, target, &KIND, stated_s)
            .into_iter()
            .collect()
    }

    fn noun(&self) -> &'static str {
        "delay"
    }

    fn tell_apart(&self) -> &'static str {
        "A delay shifts all frequencies alike; a lag makes fast ones smaller. In open loop no recording tells a delay of the torque from one of the reading."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a torque that comes {time} late"
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        if let Some(less) = found.shortened_by("time") {
            return Phrase(vec![
                Part::Words("a torque that comes ".into()),
                Part::Number(less),
                Part::Words(" sooner than the model has it".into()),
            ]);
        }
        self.filled_template(found)
    }
}
