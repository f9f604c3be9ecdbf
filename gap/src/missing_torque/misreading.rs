//! The missing torque that an error of the position sensor causes.
//!
//! A reading y = s(x) of a position x moves as if the torque `s'(x) T(x) + J s''(x) v² − T(y)` were missing, where T is the torque of the
//! device.

use super::path::{Moment, Path, torque};

/// Sensor error per unit of coefficient, over half of the range of the position.
pub(crate) const STEP: f64 = 0.1;

/// The apparent missing torque for a sensor error. `error` returns the error at a reading and its first two derivatives.
pub(crate) fn misread(path: &Path<'_>, error: impl Fn(f64) -> [f64; 3]) -> Vec<f64> {
    let m = &path.device.mechanics;
    let steps = (0..path.position.len()).map(|i| {
        let reading = path.at(i);
        let [e, slope, curvature] = error(reading.position);
        let real = Moment {
            position: reading.position - e,
            velocity: reading.velocity / (1.0 + slope),
            ..reading
        };
        let drive = path.drive[i];
        (1.0 + slope) * torque(m, drive, &real)
            + m.inertia * curvature * real.velocity * real.velocity
            - torque(m, drive, &reading)
    });
    steps.collect()
}
