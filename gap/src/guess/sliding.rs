//! Dry friction while sliding, as a regressor of the missing torque.

use super::Evidence;
use super::regression::Moment;
use crate::term::Term;

/// Dry friction of the model at a moment of sliding, by its level for positive motion, N m.
pub(crate) fn friction_nm(e: &Evidence<'_>, m: &Moment) -> f64 {
    -e.device.mechanics.friction.level_nm[0] * m.velocity.signum()
}

/// True if the device has dry friction that an effect could change.
pub(crate) fn is_dry(e: &Evidence<'_>) -> bool {
    e.device.mechanics.friction.highest_nm() > 0.0
}

/// Another level of friction over that of the model, where regression finds so much `more` of it.
pub(crate) fn times(more: f64) -> f64 {
    (1.0 + more).max(0.1)
}

/// The term that explains most of the missing torque, each with the sum of squares that it explains, (N m)².
pub(crate) fn most_telling(tried: impl Iterator<Item = (f64, Term)>) -> Option<Term> {
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, term)| term)
}
