//! Torques that pull back to a place: on small motion a weight is a spring.

use super::identification::SmallMotion;
use crate::term::Term;

/// What an effect does on small motion that is `fitted` with the slope of a torque and the place where it vanishes as its first
/// parameters, in place of those that are `stated`.
pub(super) fn small_motion(fitted: &Term, stated: [f64; 2]) -> SmallMotion {
    SmallMotion::Restoring {
        fitted: [fitted.values[0], fitted.values[1]],
        stated,
    }
}

/// A term of such an effect begun where it does the same as another one, in place of what is `stated` of its own; `None` if that
/// would push away, or if the other is of another family.
pub(super) fn begun(own: &Term, other: SmallMotion, stated: [f64; 2]) -> Option<Term> {
    let SmallMotion::Restoring {
        fitted,
        stated: others,
    } = other
    else {
        return None;
    };
    let moment = |[slope, zero]: [f64; 2]| slope * zero;
    let slope = stated[0] + fitted[0] - others[0];
    let zero = (moment(stated) + moment(fitted) - moment(others)) / slope;
    (slope > 0.0 && zero.is_finite()).then(|| own.begun(&[(0, slope), (1, zero)]))
}
