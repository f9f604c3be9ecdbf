//! Friction that grows with the square of the speed.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = Q v |v|`.
pub const KIND: Kind = Kind {
    name: "quadratic_drag",
    channel: Channel::Friction,
    about: "Friction that grows with the square of the speed",
    equation: "F = Q v |v|",
    sizes_from: "The coefficient is an assumption: at 10 rad/s the drag is from 1 mN m to 1 N m. The dry friction of the paddle's model is 15 mN m.",
    parameters: &[Parameter {
        name: "coefficient",
        quantity: Quantity::Drag,
        range: NOT_NEGATIVE,
        default: 1e-3,
        typical: [1e-5, 1e-2],
        about: "coefficient at the joint",
    }],
    install: |device, p| {
        device.mechanics.drag = p[0];
    },
    ..PLAIN
};
