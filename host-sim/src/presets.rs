//! The lab's paddle: its nominal model, and the one that was refitted to its logs.

use crate::device::Device;
use crate::motor::Motor;
use crate::plant::Friction;
use recording::Model;

/// Turns of the motor per turn of the paddle: 75 mm over 5 mm.
const RATIO: f64 = 15.0;

/// The lab's nominal model: its published inertia, viscous friction and gravity, and the 1 mN m of dry friction at the
/// motor of the report's section 3.1.1. No stops.
pub fn nominal() -> Model {
    Model {
        viscous: 1.78e-4,
        coulomb: RATIO * 1.0e-3,
        gravity: 0.01464,
        ratio: RATIO,
        input_limit: Some(0.0323),
        ..Model::new(5.755e-4)
    }
}

/// The paddle as refitted to the lab's encoder step logs (0.027° rms at the joint): asymmetric dry friction with a
/// slightly higher static level, and more viscous friction than the nominal model.
pub fn refit() -> Device {
    let model = Model {
        inertia: 5.52e-4,
        viscous: 3.9e-3,
        ..nominal()
    };
    let mut device = Device::nominal(&model);
    device.mechanics.friction = Friction {
        level_nm: [RATIO * 0.585e-3, RATIO * 0.375e-3],
        static_ratio: 1.08,
        stribeck_velocity: 0.1,
        ..Friction::coulomb(0.0)
    };
    device
}

/// The lab's maxon 339156 on 24 V.
pub fn motor() -> Motor {
    Motor {
        resistance_ohm: 10.6,
        inductance_h: 1.25e-3,
        torque_constant_nm_per_a: 53.8e-3,
        supply_v: 24.0,
    }
}
