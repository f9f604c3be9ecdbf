//! Dry friction that grows with the torque that is transmitted.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `F = (F_c + µ |T|) sign(v)`.
pub const KIND: Kind = Kind {
    name: "load_dependent_friction",
    channel: Channel::Friction,
    about: "Dry friction that grows with the torque that is transmitted",
    equation: "F = (F_c + µ |T|) sign(v)",
    parameters: &[Parameter {
        name: "share",
        quantity: Quantity::Ratio,
        range: NOT_NEGATIVE,
        default: 0.15,
        typical: [0.02, 0.5],
        about: "of the driving torque that is added to the level",
    }],
    events: None,
    install: |device, p| {
        device.mechanics.friction.load_share = p[0];
    },
};
