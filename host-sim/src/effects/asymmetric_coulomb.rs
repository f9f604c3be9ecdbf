//! Dry friction with different levels in the two directions.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = F₊ for v > 0, −F₋ for v < 0`.
pub const KIND: Kind = Kind {
    name: "asymmetric_coulomb",
    channel: Channel::Friction,
    about: "Dry friction that depends on the direction",
    equation: "F = F₊ for v > 0, −F₋ for v < 0",
    sizes_from: "One paddle of the lab has 1.65 mN m against positive and 1.20 mN m against negative motion at the motor, which is 25 and 18 mN m at the paddle. The range goes to twice that.",
    parameters: &[
        Parameter {
            name: "positive",
            quantity: Quantity::Torque,
            range: NOT_NEGATIVE,
            default: 0.025,
            typical: [0.0, 0.05],
            about: "level against positive motion",
        },
        Parameter {
            name: "negative",
            quantity: Quantity::Torque,
            range: NOT_NEGATIVE,
            default: 0.015,
            typical: [0.0, 0.05],
            about: "level against negative motion",
        },
    ],
    install: |device, p| {
        device.mechanics.friction.level_nm = [p[0], p[1]];
    },
    ..PLAIN
};
