//! Dry friction whose level differs from the model's.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = F_c sign(v)`.
pub const KIND: Kind = Kind {
    name: "coulomb",
    channel: Channel::Friction,
    about: "Dry friction that differs from the model's",
    equation: "F = F_c sign(v)",
    sizes_from: "Paddles of the lab have 1.1 to 1.65 mN m at the motor, which is 17 to 25 mN m at the paddle. The range goes to twice that.",
    parameters: &[Parameter {
        name: "level",
        quantity: Quantity::Torque,
        range: NOT_NEGATIVE,
        default: 0.02,
        typical: [0.0, 0.05],
        about: "sliding and static level in both directions",
    }],
    install: |device, p| {
        device.mechanics.friction.level_nm = [p[0]; 2];
    },
    ..PLAIN
};
