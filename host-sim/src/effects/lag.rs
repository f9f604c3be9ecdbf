//! The torque follows the input through a first-order lag.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `τ T' + T = ratio · u`.
pub const KIND: Kind = Kind {
    name: "lag",
    channel: Channel::Actuation,
    about: "The torque follows the input through a first-order lag",
    equation: "τ T' + T = ratio · u",
    parameters: &[Parameter {
        name: "time",
        quantity: Quantity::Time,
        range: NOT_NEGATIVE,
        default: 0.003,
        typical: [0.0005, 0.02],
        about: "time constant on top of the model's",
    }],
    events: None,
    install: |device, p| {
        device.drive.lag_s += p[0];
    },
};
