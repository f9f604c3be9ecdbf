//! A dead time that differs from the model's.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};

/// `T(t) = ratio · u(t − d)`.
pub const KIND: Kind = Kind {
    name: "delay",
    channel: Channel::Actuation,
    about: "The torque follows the input later, or sooner, than the model knows",
    equation: "T(t) = ratio · u(t − d)",
    sizes_from: "The shortest is near one control period of the lab's board, 0.35 ms. The longest is an assumption for a slow bus.",
    parameters: &[Parameter {
        name: "time",
        quantity: Quantity::Time,
        range: ANY,
        default: 0.003,
        typical: [0.0005, 0.02],
        about: "delay in addition to the model's; negative if the model's is too long",
    }],
    install: |device, p| {
        // A delay below zero is that of an input column that is late.
        let least_s = device.drive.delay_s.min(0.0);
        device.drive.delay_s = (device.drive.delay_s + p[0]).max(least_s);
    },
    ..PLAIN
};
