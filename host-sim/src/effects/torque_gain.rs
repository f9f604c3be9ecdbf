//! A torque gain that differs from the model's.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};

/// `T = g · ratio · u`.
pub const KIND: Kind = Kind {
    name: "torque_gain",
    channel: Channel::Actuation,
    about: "The actuator gives more or less torque than commanded",
    equation: "T = g · ratio · u",
    sizes_from: "The range is an assumption: a torque constant and a gear are known to some 10 %, and some errors are larger.",
    parameters: &[Parameter {
        name: "gain",
        quantity: Quantity::Ratio,
        range: ANY,
        default: 0.85,
        typical: [0.6, 1.4],
        about: "torque over the commanded torque",
    }],
    install: |device, p| {
        device.drive.ratio *= p[0];
    },
    ..PLAIN
};
