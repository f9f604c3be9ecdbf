//! Large inputs are clipped earlier than the model knows.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `T = ratio · clamp(u, ±limit)`.
pub const KIND: Kind = Kind {
    name: "saturation",
    channel: Channel::Actuation,
    about: "Large inputs are clipped earlier than the model knows",
    equation: "T = ratio · clamp(u, ±limit)",
    parameters: &[Parameter {
        name: "limit",
        quantity: Quantity::Input,
        range: NOT_NEGATIVE,
        default: 0.01,
        typical: [0.003, 0.03],
        about: "largest input that acts",
    }],
    install: |device, p| {
        device.drive.limit = device.drive.limit.min(p[0]);
    },
};
