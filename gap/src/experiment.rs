//! The excitation of the firmware that would tell rival models apart best.

use crate::diagnosis::NextExperiment;
use crate::fit::Problem;
use crate::select::Selection;

/// The best excitation for what the selection leaves open; `None` if nothing is.
pub(crate) fn separating(_problem: &Problem<'_>, _selection: &Selection) -> Option<NextExperiment> {
    None
}
