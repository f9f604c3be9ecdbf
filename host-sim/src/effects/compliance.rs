//! A compliant transmission between motor and load.

use super::{
    Channel, INERTIA_SHARE, Kind, LOAD_FRICTION, NOT_NEGATIVE, PLAIN, Parameter, Quantity,
};
use crate::plant::Link;

/// `T = K d + D d'`.
pub const KIND: Kind = Kind {
    name: "compliance",
    channel: Channel::Mechanics,
    about: "A transmission that twists between motor and load",
    equation: "T = K d + D d'",
    sizes_from: "The stiffness of the paddle's cable was not measured; all sizes are assumptions. With half of the paddle's inertia on either side the range is that of resonances of 9 to 133 Hz.",
    parameters: &[
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 5.0,
            typical: [0.5, 100.0],
            about: "stiffness of the transmission",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 1e-3,
            typical: [0.0, 1e-2],
            about: "damping of the twist",
        },
        Parameter {
            name: "load_share",
            quantity: Quantity::Ratio,
            range: INERTIA_SHARE,
            default: 0.4,
            typical: [0.1, 0.9],
            about: "share of the inertia behind the twist",
        },
        LOAD_FRICTION,
    ],
    install: |device, p| {
        device.mechanics.link = Some(Link {
            load_share: p[2],
            stiffness: p[0],
            damping: p[1],
            play: 0.0,
            load_friction: p[3],
            sensor_on_load: device.sensor_on_load,
        });
    },
    ..PLAIN
};
