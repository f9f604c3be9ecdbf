//! The torque that seems to be missing where a sensor shows another position than there is.
//!
//! A reading y = s(x) of a position x moves as if the torque `s'(x) T(x) + J s''(x) v² − T(y)` were missing, where T is
//! what the device itself does.

use super::path::{Moment, Path, torque};

/// Size of an error for a unit of its coefficient, over half of the span.
pub(crate) const STEP: f64 = 0.1;

/// The torque that seems to be missing where the reading is off by `error(x)`, with its first two derivatives.
pub(crate) fn misread(path: &Path<'_>, error: impl Fn(f64) -> [f64; 3]) -> Vec<f64> {
    let m = &path.device.mechanics;
    let steps = (0..path.position.len()).map(|i| {
        let shown = path.at(i);
        let [e, slope, bend] = error(shown.position);
        let is = Moment {
            position: shown.position - e,
            velocity: shown.velocity / (1.0 + slope),
            ..shown
        };
        let drive = path.drive[i];
        (1.0 + slope) * torque(m, drive, &is) + m.inertia * bend * is.velocity * is.velocity
            - torque(m, drive, &shown)
    });
    steps.collect()
}
