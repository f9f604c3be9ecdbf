//! A mass on a lever that has a given weight torque.

use host_sim::device::Device;

/// Acceleration of gravity that the exports state, m/s².
pub(crate) const GRAVITY_M_S2: f64 = 9.81;

/// What swings: a mass on a lever, and the inertia that it leaves for the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pendulum {
    pub mass_kg: f64,
    pub lever_m: f64,
    /// Angle at which it hangs, rad.
    pub hangs_at: f64,
    /// The rest of the inertia, kg m².
    pub rest: f64,
}

/// Share of the inertia that the mass on the lever takes.
const SHARE: f64 = 0.5;
/// Mass of what has no weight torque, kg.
const MASS_KG: f64 = 1.0;

impl Pendulum {
    /// The pendulum of an inertia that has the device's weight torque.
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
