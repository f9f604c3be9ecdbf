//! Dry friction that grows with the torque that is transmitted.

use super::{ANY, Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `F = (F_c + µ |T + p P(x)|) sign(v)`, where P pulls whatever the drive does.
pub const KIND: Kind = Kind {
    name: "load_dependent_friction",
    channel: Channel::Friction,
    about: "Dry friction that grows with the torque that is transmitted",
    equation: "F = (F_c + µ |T + p P(x)|) sign(v)",
    parameters: &[
        Parameter {
            name: "share",
            quantity: Quantity::Ratio,
            range: NOT_NEGATIVE,
            default: 0.15,
            typical: [0.02, 0.5],
            about: "of the torque that is transmitted, which is added to the level",
        },
        Parameter {
            name: "passive",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-1.0, 1.0],
            about: "part of the pull of gravity and springs that is transmitted beside the drive",
        },
    ],
    events: None,
    install: |device, p| {
        let friction = &mut device.mechanics.friction;
        friction.load_share = p[0];
        friction.load_passive = p[1];
    },
};
