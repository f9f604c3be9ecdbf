//! The verdict: whether a gap exists, and whether the findings explain it.

use super::confounder::Confounder;
use crate::diagnosis::{Closing, NumberFinding, Verdict};
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::select::{self, Selection};

/// Largest share of the robust excess that may remain if the gap is at its floor. A wrong effect in place of a periodic disturbance can
/// reach the floor through the few windows with large errors.
const MOST_MISSING_AT_FLOOR: f64 = 0.25;

/// The verdict on a selection that closes the gap as `closing` states, with a reason to doubt it, if any.
pub(super) fn verdict(
    problem: &Problem<'_>,
    selection: &Selection,
    closing: &Closing,
    doubt: Option<Confounder>,
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

/// The verdict on a model without effects whose parameters moved, from its `verdict` without them. A parameter that moved beyond its
/// tolerance counts as an effect.
pub(super) fn with_numbers(
    verdict: Verdict,
    numbers: &[NumberFinding],
    closing: &Closing,
) -> Verdict {
    let are_within = numbers.iter().all(NumberFinding::is_within_tolerance);
    if verdict != Verdict::Unexplained || are_within {
        verdict
    } else if closing.after <= FLOOR_DOUBT * closing.floor {
        Verdict::Explained
    } else {
        Verdict::PartlyExplained
    }
}
