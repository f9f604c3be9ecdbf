//! Static friction above the sliding level.

use super::{Channel, Kind, Parameter, Quantity};

/// `F = F_c [1 + (r − 1) e^−(v/v_s)²] sign(v)`.
pub const KIND: Kind = Kind {
    name: "stribeck",
    channel: Channel::Friction,
    about: "Static friction above the sliding level",
    equation: "F = F_c [1 + (r − 1) e^−(v/v_s)²] sign(v)",
    parameters: &[
        Parameter {
            name: "static_ratio",
            quantity: Quantity::Ratio,
            default: 1.4,
            typical: [1.05, 2.5],
            about: "static over sliding level",
        },
        Parameter {
            name: "velocity",
            quantity: Quantity::Velocity,
            default: 0.1,
            typical: [0.01, 2.0],
            about: "over which the level falls",
        },
    ],
    install: |device, p| {
        device.mechanics.friction.static_ratio = p[0].max(0.0);
        device.mechanics.friction.stribeck_velocity = p[1].abs().max(f64::MIN_POSITIVE);
    },
};
