//! All main numbers of the model at once, from the balance of torques along the recorded motion.

use super::Evidence;
use super::regression::regress;

/// The main numbers of a device, by one regression of the torque that the nominal model misses on all of them: each alone would take
/// what another leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// Torque over what the model makes of the input.
    pub gain: f64,
    /// In the model's units of torque s²/position.
    pub inertia: f64,
    /// In the model's units of torque s/position.
    pub viscous: f64,
    /// In the model's units of torque.
    pub coulomb: f64,
    /// Amplitude of the torque of gravity, likewise.
    pub weight: f64,
    /// Position at which it hangs, in units of position.
    pub zero: f64,
}

/// Share of the stated inertia that a regression may come down to: noise of the acceleration draws it towards none.
const LEAST_INERTIA: f64 = 0.02;

impl Balance {
    /// From what is seen beyond a device; with the gain free and the inertia as it is, or the other way round: one scales with the
    /// other. `None` where the motion does not determine all of them.
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
    fn numbers_that_are_all_off_are_found_together() {
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
