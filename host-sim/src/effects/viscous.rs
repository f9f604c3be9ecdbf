//! Friction that grows with speed.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = B v`.
pub const KIND: Kind = Kind {
    name: "viscous",
    channel: Channel::Friction,
    about: "Friction that grows with speed",
    equation: "F = B v",
    parameters: &[Parameter {
        name: "coefficient",
        quantity: Quantity::Damping,
        range: NOT_NEGATIVE,
        default: 4e-3,
        typical: [0.0, 2e-2],
        about: "in place of the model's",
    }],
    install: |device, p| {
        device.mechanics.viscous = p[0];
    },
    ..PLAIN
};
