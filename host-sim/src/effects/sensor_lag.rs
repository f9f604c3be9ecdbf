//! The sensor follows through a first-order lag.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `τ y' + y = x`.
pub const KIND: Kind = Kind {
    name: "sensor_lag",
    channel: Channel::Sensing,
    about: "The sensor follows through a first-order lag",
    equation: "τ y' + y = x",
    parameters: &[Parameter {
        name: "time",
        quantity: Quantity::Time,
        range: NOT_NEGATIVE,
        default: 0.004,
        typical: [0.0005, 0.02],
        about: "time constant",
    }],
    events: None,
    install: |device, p| {
        device.sensing.lag_s = p[0];
    },
};
