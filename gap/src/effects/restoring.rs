//! Torques towards one position. On small motion a weight acts like a spring.

use super::identification::SmallMotion;
use crate::term::Term;

/// The action on small motion of an effect whose first two parameters are the slope of a torque and the position at which it is zero. The
/// fitted parameters replace the `stated` ones.
pub(super) fn small_motion(fitted: &Term, stated: [f64; 2]) -> SmallMotion {
    SmallMotion::Restoring {
        fitted: [fitted.values[0], fitted.values[1]],
        stated,
    }
}

/// A start of a restoring effect at the values with which it acts like another one on small motion. Its parameters replace its `stated`
/// ones. Returns `None` if the torque would push away from its position, or if the other effect belongs to another family.
pub(super) fn equivalent_start(own: &Term, other: SmallMotion, stated: [f64; 2]) -> Option<Term> {
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
    (slope > 0.0 && zero.is_finite()).then(|| own.starting_at(&[(0, slope), (1, zero)]))
}
