//! The torque follows the input late.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `T(t) = ratio · u(t − d)`.
pub const KIND: Kind = Kind {
    name: "delay",
    channel: Channel::Actuation,
    about: "The torque follows the input late",
    equation: "T(t) = ratio · u(t − d)",
    parameters: &[Parameter {
        name: "time",
        quantity: Quantity::Time,
        range: NOT_NEGATIVE,
        default: 0.003,
        typical: [0.0005, 0.02],
        about: "delay on top of the model's",
    }],
    events: None,
    install: |device, p| {
        device.drive.delay_s += p[0];
    },
};
