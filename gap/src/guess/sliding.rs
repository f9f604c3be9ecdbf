//! Coulomb friction during sliding, as a regressor of the missing torque.

use super::Evidence;
use super::regression::Moment;
use crate::term::Term;

/// Coulomb friction torque of the model at an instant of sliding, with the level for positive velocity, N m.
pub(crate) fn friction_nm(e: &Evidence<'_>, m: &Moment) -> f64 {
    -e.device.mechanics.friction.level_nm[0] * m.velocity.signum()
}

/// True if the model has Coulomb friction that an effect can change.
pub(crate) fn has_coulomb_friction(e: &Evidence<'_>) -> bool {
    e.device.mechanics.friction.highest_nm() > 0.0
}

/// Ratio of a new friction level to that of the model, from the additional share `more` of a regression. It is at least 0.1.
pub(crate) fn level_ratio(more: f64) -> f64 {
    (1.0 + more).max(0.1)
}

/// The term with the largest explained sum of squares. Each candidate comes with the sum of squares of the missing torque that it
/// explains, (N m)².
pub(crate) fn best_explaining(tried: impl Iterator<Item = (f64, Term)>) -> Option<Term> {
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, term)| term)
}
