//! An encoder that loses counts, at single instants or during fast motion.

mod jumps;
mod overspeed;

use super::identification::{Fitted, Identification};
use super::phrase::{Found, Phrase};
use crate::columns::Disagreement;
use crate::guess::Evidence;
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::series::Series;
use host_sim::effects::Kind;
use host_sim::effects::lost_counts::KIND;

#[derive(Debug)]
pub(super) struct LostCounts;

impl Identification for LostCounts {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        [jumps::starts(e), overspeed::starts(e)].concat()
    }

    fn is_local(&self) -> bool {
        true
    }

    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        let speeds = fit.series.iter().flat_map(Series::restart_speeds);
        overspeed::loses_at_every_speed(fit.term, &speeds.collect::<Vec<f64>>())
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let jumps = jumps::between_columns(columns).into_iter();
        jumps.chain(overspeed::between_columns(columns)).collect()
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let mut forms = overspeed::torque_forms(path);
        forms.extend(jumps::torque_forms(path, target));
        forms
    }

    fn noun(&self) -> &'static str {
        "lost counts"
    }

    fn tell_apart(&self) -> &'static str {
        "The reading jumps once and stays off, or falls behind above one speed. A contact pushes the joint away and lets it come back. Return to a known mark, such as an index or a stop, at the end of the session."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.fitted("share") {
            Some(_) => "a sensor that loses {share} of the speed beyond {speed}",
            None => "a sensor that jumps by {jump} at {time}",
        }
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        if found.fitted("share").is_none() && found.estimate("jump").is_none() {
            let times = found.count("jump");
            return Phrase::of(format!("a sensor that jumps {times} times"));
        }
        self.filled_template(found)
    }
}
