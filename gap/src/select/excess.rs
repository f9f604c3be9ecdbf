//! What a fit leaves beyond noise and restarts.

use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::floor::{ExpectedLoss, FLOOR_DOUBT};

/// Robust excess per window up to which nothing is missing: the noise is known to some 15 %.
pub(super) const QUIET_EXCESS: f64 = 0.12;
/// And this many standard errors of what a perfect model leaves.
pub(super) const QUIET_ERRORS: f64 = 2.0;
/// Robust cost by which a window may exceed the worst of a perfect model.
const QUIET_WINDOW: f64 = 3.0;
/// Gap over floor up to which nothing that can be named is missing: near stick and slip a few restarts may decide either.
pub(crate) const QUIET_GAP: f64 = 2.0;
/// Gap over floor beyond which something is, be it in a restart or two: of 90 recordings with nothing wrong the largest was
/// 1.8.
pub(crate) const LOUD_GAP: f64 = 3.0;
/// Share of the robust excess that named effects may leave; a wrong name for a foreign cause leaves more.
pub(crate) const MOST_LEFT: f64 = 0.7;
/// Share of the excess that may be left where nothing else of its size is missing: as much as a further effect must close
/// to earn its place. Several wrong names together may bring the gap of a foreign cause near the floor, not this.
pub(crate) const MOST_LEFT_EXPLAINED: f64 = 0.1;

/// Robust cost of a fit, the mean over its windows, with what it moves the model's own numbers for.
pub(super) fn level(fit: &Fit) -> f64 {
    fit.costs.level()
}

/// True if a fit leaves no more than a perfect model may, in the mean and in the worst window, and the model's own
/// numbers need not move farther for it than their tolerances let one expect.
pub(super) fn is_quiet(fit: &Fit, expected: &ExpectedLoss) -> bool {
    let windows = 0..fit.costs.per_sample.len();
    let worst = windows.fold(0.0f64, |worst, w| worst.max(fit.costs.log(w)));
    fit.is_likely()
        && fit.costs.mean() - expected.level <= QUIET_EXCESS + QUIET_ERRORS * expected.error
        && worst - expected.level <= expected.worst + QUIET_WINDOW
}

/// True if a fit leaves no more of the gap than noise and restarts do, and need not bend the model's own numbers for it.
pub(super) fn is_at_floor(problem: &Problem<'_>, fit: &Fit) -> bool {
    !fit.is_strained() && problem.gap_over_floor(fit) <= FLOOR_DOUBT
}
