//! The excess is the robust cost of a fit beyond the expected cost of an exact model. An exact model has a cost because of noise and
//! restarts.
//!
//! The gap is the rms residual of a fit. Its floor is the rms residual of an exact model.

use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};

/// Largest excess per window of an adequate model. The sensor noise is known to about 15 %.
pub(super) const ADEQUATE_EXCESS: f64 = 0.12;
/// Largest further excess of an adequate model, in standard errors of the cost of an exact model.
pub(super) const ADEQUATE_ERRORS: f64 = 2.0;
/// Robust cost by which the worst window of an adequate model may exceed the worst window of an exact model.
const ADEQUATE_WINDOW: f64 = 3.0;
/// Largest gap over floor of an adequate model. Near stick and slip a few restarts determine gap and floor.
pub(crate) const ADEQUATE_GAP: f64 = 2.0;
/// Gap over floor beyond which an effect is surely missing, even if only one or two windows contain the gap. The largest value of 90
/// recordings without a missing effect was 1.8.
pub(crate) const PLAIN_GAP: f64 = 3.0;
/// Largest share of the excess of the null that may remain with the named effects. A wrong name for a cause outside the library has a
/// larger remaining share.
pub(crate) const MOST_LEFT: f64 = 0.7;
/// Largest share of the excess of the null that may remain if the effects explain everything. A further effect must close as much to be
/// accepted. Several wrong effects together may bring the gap of a cause outside the library near its floor, but not the excess below this
/// share.
pub(crate) const MOST_LEFT_EXPLAINED: f64 = 0.1;

/// Returns the objective of a fit per window: the mean robust cost of its windows plus the prior cost per window.
pub(super) fn level(fit: &Fit) -> f64 {
    fit.costs.level()
}

/// Returns true if the mean cost and the worst window of a fit are within the limits of an adequate model, and the deviations of the model
/// parameters are plausible for their tolerances.
pub(super) fn is_adequate(fit: &Fit, expected: &ExpectedLoss) -> bool {
    let windows = 0..fit.costs.per_sample.len();
    let worst = windows.fold(0.0f64, |worst, w| worst.max(fit.costs.log(w)));
    fit.is_likely()
        && fit.costs.mean() - expected.level <= ADEQUATE_EXCESS + ADEQUATE_ERRORS * expected.error
        && worst - expected.level <= expected.worst + ADEQUATE_WINDOW
}

/// Returns true if the gap of a fit is at its floor and no model parameter deviates so far that it seems to compensate another error.
pub(super) fn is_at_floor(problem: &Problem<'_>, fit: &Fit) -> bool {
    !fit.is_strained() && problem.gap_over_floor(fit) <= FLOOR_DOUBT
}
