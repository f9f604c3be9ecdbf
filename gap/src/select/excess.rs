//! The excess: robust cost of a fit beyond that of an exact model, which noise and restarts alone make.

use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};

/// Excess per window up to which a model is adequate: the noise of the sensor is known to some 15 %.
pub(super) const ADEQUATE_EXCESS: f64 = 0.12;
/// Standard errors of the cost of an exact model that are allowed on top of that.
pub(super) const ADEQUATE_ERRORS: f64 = 2.0;
/// Robust cost by which the worst window may exceed the worst one of an exact model.
const ADEQUATE_WINDOW: f64 = 3.0;
/// Gap over floor up to which a model is adequate. Near stick and slip a few restarts decide how large gap and floor are.
pub(crate) const ADEQUATE_GAP: f64 = 2.0;
/// Gap over floor beyond which something is surely missing, even if the gap is in a window or two. The largest of 90 recordings with
/// nothing wrong was 1.8.
pub(crate) const PLAIN_GAP: f64 = 3.0;
/// Share of the excess that named effects may leave. A wrong name for a cause outside the library leaves more.
pub(crate) const MOST_LEFT: f64 = 0.7;
/// Share of the excess that may be left by effects that explain everything: a further effect must close as much to be accepted. Several
/// wrong names together may bring the gap of a cause outside the library near the floor, but not the excess below this.
pub(crate) const MOST_LEFT_EXPLAINED: f64 = 0.1;

/// Robust cost of a fit, as the mean over its windows, with the cost of moving the numbers of the model.
pub(super) fn level(fit: &Fit) -> f64 {
    fit.costs.level()
}

/// True if a fit costs no more than an exact model may, in the mean and in the worst window, and moves the numbers of the model no
/// farther than their tolerances let one expect.
pub(super) fn is_adequate(fit: &Fit, expected: &ExpectedLoss) -> bool {
    let windows = 0..fit.costs.per_sample.len();
    let worst = windows.fold(0.0f64, |worst, w| worst.max(fit.costs.log(w)));
    fit.is_likely()
        && fit.costs.mean() - expected.level <= ADEQUATE_EXCESS + ADEQUATE_ERRORS * expected.error
        && worst - expected.level <= expected.worst + ADEQUATE_WINDOW
}

/// True if the gap of a fit is at its floor, without an unlikely move of the numbers of the model.
pub(super) fn is_at_floor(problem: &Problem<'_>, fit: &Fit) -> bool {
    !fit.is_strained() && problem.gap_over_floor(fit) <= FLOOR_DOUBT
}
