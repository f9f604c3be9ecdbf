//! Backlash between motor and load.

use super::{
    Channel, INERTIA_SHARE, Kind, LOAD_FRICTION, NOT_NEGATIVE, PLAIN, Parameter, Quantity,
};
use crate::plant::Link;

/// `T = 0` within the play, `K d` beyond it.
pub const KIND: Kind = Kind {
    name: "backlash",
    channel: Channel::Mechanics,
    about: "Play between motor and load",
    equation: "T = 0 within the play, K d beyond",
    sizes_from: "No play was measured on the paddle; all sizes are assumptions. The play goes from ten steps of the paddle's encoder (0.21 mrad each) to 6°.",
    parameters: &[
        Parameter {
            name: "play",
            quantity: Quantity::Position,
            range: NOT_NEGATIVE,
            default: 0.02,
            typical: [0.002, 0.1],
            about: "free travel between the flanks",
        },
        Parameter {
            name: "load_share",
            quantity: Quantity::Ratio,
            range: INERTIA_SHARE,
            default: 0.4,
            typical: [0.1, 0.9],
            about: "share of the inertia behind the play",
        },
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 50.0,
            typical: [5.0, 500.0],
            about: "stiffness of the flanks",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 0.01,
            typical: [0.0, 0.1],
            about: "damping of the flanks in contact",
        },
        LOAD_FRICTION,
    ],
    install: |device, p| {
        device.mechanics.link = Some(Link {
            load_share: p[1],
            stiffness: p[2],
            damping: p[3],
            play: p[0],
            load_friction: p[4],
            sensor_on_load: device.sensor_on_load,
        });
    },
    ..PLAIN
};
