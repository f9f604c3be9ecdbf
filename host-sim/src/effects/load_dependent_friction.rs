//! Dry friction that grows with the transmitted torque.

use super::{ANY, Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = (F_c + µ |T + p P(x)|) sign(v)`, where P is the torque of gravity and springs. Where the transmitted torque acts
/// against the motion, the load drives the motor and µ is replaced by `µ + b`, which is never below zero: the friction of a gear differs
/// when the load drives it.
pub const KIND: Kind = Kind {
    name: "load_dependent_friction",
    channel: Channel::Friction,
    about: "Dry friction that grows with the torque that is transmitted",
    equation: "F = (F_c + µ |T + p P(x)|) sign(v), with µ + b where T + p P acts against v",
    sizes_from: "The shares are an assumption: a transmission with an efficiency η of 98 to 50 % where the motor drives. Where the load drives, the friction is 1/η − 1 of the motor's torque; 4 is an efficiency of 20 %.",
    parameters: &[
        Parameter {
            name: "share",
            quantity: Quantity::Ratio,
            range: NOT_NEGATIVE,
            default: 0.15,
            typical: [0.0, 0.5],
            about: "share of the transmitted torque that is added to the level",
        },
        Parameter {
            name: "passive",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-1.0, 1.0],
            about: "share of the torque of gravity and springs that counts as transmitted in addition to the drive's",
        },
        Parameter {
            name: "backdriven_extra",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 4.0],
            about: "share that is added to `share` where the load drives the motor",
        },
    ],
    install: |device, p| {
        let friction = &mut device.mechanics.friction;
        friction.load_share = p[0];
        friction.load_passive = p[1];
        friction.load_backdriven_extra = p[2];
    },
    ..PLAIN
};
