//! Estimates all main parameters of the model at once, from the balance of torques along the recorded motion.

use super::Evidence;
use super::regression::regress;

/// The main parameters of a device, by one regression of the missing torque on all of them. Separate regressions would be biased, because
/// each would absorb the errors of the other parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// Ratio of the real drive torque to that of the model.
    pub gain: f64,
    /// Inertia, N m s²/position unit.
    pub inertia: f64,
    /// Viscous friction, N m s/position unit.
    pub viscous: f64,
    /// Coulomb friction, N m.
    pub coulomb: f64,
    /// Amplitude of the gravity torque, N m.
    pub weight: f64,
    /// Position at which the gravity torque is zero, in position units.
    pub zero: f64,
}

/// Least share of the stated inertia that the regression may return. Noise of the acceleration biases the inertia towards zero.
const LEAST_INERTIA: f64 = 0.02;

impl Balance {
    /// Estimates the parameters from the evidence. Either the gain is estimated and the inertia kept, or the reverse, since only their
    /// ratio is observable. Returns `None` if the motion does not determine all parameters.
    pub(crate) fn of(evidence: &Evidence<'_>, is_gain_free: bool) -> Option<Self> {
        let device = &evidence.device.mechanics;
        let angle_rad = device.angle_rad;
        let [accelerates, viscous, coulomb, sine, cosine] = regress(evidence, |moment| {
            let (sin, cos) = (angle_rad * moment.position).sin_cos();
            let accelerates = if is_gain_free {
                moment.drive_nm
            } else {
                -moment.acceleration
            };
            let direction = moment.velocity.signum();
            [accelerates, -moment.velocity, -direction, -sin, cos]
        })?;
        let (sin, cos) = (angle_rad * device.gravity_zero).sin_cos();
        let [sine, cosine] = [sine + device.gravity * cos, cosine + device.gravity * sin];
        let [gain, inertia] = if is_gain_free {
            [1.0 + accelerates, device.inertia]
        } else {
            let least = LEAST_INERTIA * device.inertia;
            [1.0, (device.inertia + accelerates).max(least)]
        };
        Some(Self {
            gain,
            inertia,
            viscous: device.viscous + viscous,
            coulomb: (device.friction.level_nm[0] + coulomb).max(0.0),
            weight: sine.hypot(cosine),
            zero: cosine.atan2(sine) / angle_rad,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn parameters_that_are_all_wrong_are_estimated_together() {
        let hidden = [
            "inertia:inertia=4e-4",
            "coulomb:level=0.008",
            "viscous:coefficient=6e-4",
        ];
        let found = made::seen(&hidden, |_| {}, |evidence| Balance::of(evidence, false)).unwrap();
        for (found, hidden) in [
            (found.inertia, 4e-4),
            (found.coulomb, 0.008),
            (found.viscous, 6e-4),
        ] {
            assert!((found / hidden - 1.0).abs() < 0.15, "{found} for {hidden}");
        }
    }
}
