//! The lab's paddle: its nominal model, and a model fitted to its logs.

use crate::closed_loop::{LoopSetup, Rates};
use crate::device::Device;
use crate::motor::Motor;
use crate::plant::{Friction, Stribeck};
use crate::sensing::Sensing;
use haptic_paddle::settings::{DerivativeSource, Settings};
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

/// The paddle as fitted to the lab's logs of encoder steps (0.027° rms at the joint). It has asymmetric dry friction with a
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
        stribeck: Stribeck {
            ratio: 1.08,
            velocity: 0.1,
            ..Stribeck::NONE
        },
        ..Friction::coulomb(0.0)
    };
    device
}

/// Gain of the lab's Hall sensor relative to its calibration, fitted to its logs.
const HALL_GAIN: f64 = 1.12;
/// Lag of the lab's Hall sensor, fitted to its logs, s.
const HALL_LAG_S: f64 = 0.25e-3;

/// The fitted paddle with the lab's board: an ideal actuator, the lab's rates, and the lab's derivative.
///
/// Its Hall sensor has no noise, as in the fit. Noise would dither the dry friction and change results that depend on a few
/// hundredths of a degree at rest.
pub fn lab(mut settings: Settings) -> LoopSetup {
    settings.pid.derivative = DerivativeSource::Position;
    let mut setup = LoopSetup::ideal(refit(), settings);
    setup.rates = Rates::LAB_BOARD;
    setup.paddle.hall.noise_v = 0.0;
    setup.paddle.hall.sensing = Sensing {
        gain: HALL_GAIN,
        lag_s: HALL_LAG_S,
        ..Sensing::ideal()
    };
    setup
}

/// The lab's motor, maxon 339156, at 24 V.
pub fn motor() -> Motor {
    Motor {
        resistance_ohm: 10.6,
        inductance_h: 1.25e-3,
        torque_constant_nm_per_a: 53.8e-3,
        supply_v: 24.0,
    }
}
