//! The actuator gives more or less than it was told.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};

/// `T = g · ratio · u`.
pub const KIND: Kind = Kind {
    name: "torque_gain",
    channel: Channel::Actuation,
    about: "The actuator gives more or less than it was told",
    equation: "T = g · ratio · u",
    sizes_from: "Judgement: a torque constant and a gear are known to some 10 %; a wrong unit or gear goes further.",
    parameters: &[Parameter {
        name: "gain",
        quantity: Quantity::Ratio,
        range: ANY,
        default: 0.85,
        typical: [0.6, 1.4],
        about: "torque that comes, as a share of what was told",
    }],
    install: |device, p| {
        device.drive.ratio *= p[0];
    },
    ..PLAIN
};
