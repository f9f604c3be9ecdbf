//! A mass on a lever that has the gravity torque of the device.

use host_sim::device::Device;

/// Gravitational acceleration in the exports, m/s².
pub(crate) const GRAVITY_M_S2: f64 = 9.81;

/// A mass on a lever, and the remaining inertia for the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pendulum {
    pub mass_kg: f64,
    pub lever_m: f64,
    /// Angle at which it hangs, rad.
    pub hangs_at: f64,
    /// The remaining inertia, kg m².
    pub rest: f64,
}

/// Share of the inertia of the mass on the lever.
const SHARE: f64 = 0.5;
/// Mass of a body without gravity torque, kg.
const MASS_KG: f64 = 1.0;

impl Pendulum {
    /// The pendulum with this inertia and the gravity torque of the device.
    pub fn of(device: &Device, inertia: f64) -> Self {
        let mechanics = &device.mechanics;
        let torque = mechanics.gravity.abs();
        if torque == 0.0 {
            return Self {
                mass_kg: MASS_KG,
                lever_m: 0.0,
                hangs_at: 0.0,
                rest: inertia,
            };
        }
        // m g l = G and m l² = SHARE J.
        let lever_m = SHARE * inertia * GRAVITY_M_S2 / torque;
        let turned = if mechanics.gravity < 0.0 {
            std::f64::consts::PI
        } else {
            0.0
        };
        Self {
            mass_kg: torque / (GRAVITY_M_S2 * lever_m),
            lever_m,
            hangs_at: mechanics.gravity_zero + turned,
            rest: (1.0 - SHARE) * inertia,
        }
    }
}
