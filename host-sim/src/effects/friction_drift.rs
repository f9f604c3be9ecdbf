//! Dry friction that changes over the session.

use super::LEAST_LEVEL;
use super::{Channel, Kind, Parameter, Quantity};

/// `F = F_c (l + d t) sign(v)`.
pub const KIND: Kind = Kind {
    name: "friction_drift",
    channel: Channel::Friction,
    about: "Dry friction that changes over the session",
    equation: "F = F_c (l + d t) sign(v)",
    parameters: &[
        Parameter {
            name: "rate",
            quantity: Quantity::Frequency,
            default: 0.05,
            typical: [-0.1, 0.5],
            about: "growth per second, relative to the model's level",
        },
        Parameter {
            name: "level",
            quantity: Quantity::Ratio,
            default: 1.0,
            typical: [0.5, 2.0],
            about: "at the start, over the model's",
        },
    ],
    install: |device, p| {
        let level = p[1].max(LEAST_LEVEL);
        device.mechanics.friction.scale(level);
        device.mechanics.friction.drift_per_s = p[0] / level;
    },
};
