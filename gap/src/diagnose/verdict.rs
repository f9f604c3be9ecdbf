//! Whether there is a gap, and whether what was found explains it.

use super::stand_in::StandIn;
use crate::diagnosis::{Closing, Verdict};
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::select::{self, Selection};

/// Share of the robust excess that may be left where the gap is at its floor: a wrong name for a hum may come that near
/// by the few windows that are large.
const MOST_MISSING_AT_FLOOR: f64 = 0.25;

/// The verdict on a selection that closes the gap so far, with a reason to doubt it if there is one.
pub(super) fn verdict(
    problem: &Problem<'_>,
    selection: &Selection,
    closing: &Closing,
    doubt: Option<StandIn>,
) -> Verdict {
    if selection.rounds.is_empty() {
        let is_hidden = || selection.null_leaves_at_most(select::ADEQUATE_GAP, problem);
        return if selection.has_no_gap || (!selection.is_unambiguous && is_hidden()) {
            Verdict::NoGap
        } else {
            Verdict::Unexplained
        };
    }
    let most_missing = if closing.after <= FLOOR_DOUBT * closing.floor {
        MOST_MISSING_AT_FLOOR
    } else {
        select::MOST_LEFT_EXPLAINED
    };
    let is_explained = closing.is_closed()
        && closing.after <= select::PLAIN_GAP * closing.floor
        && selection.missing(problem, selection.fit()) <= most_missing
        && doubt.is_none();
    if is_explained {
        Verdict::Explained
    } else {
        Verdict::PartlyExplained
    }
}
