//! The sensor shows more or less than the way gone.

use super::{ANY, Channel, Kind, Parameter, Quantity};

/// `y = g x`.
pub const KIND: Kind = Kind {
    name: "sensor_gain",
    channel: Channel::Sensing,
    about: "The sensor shows more or less than the way gone",
    equation: "y = g x",
    parameters: &[Parameter {
        name: "gain",
        quantity: Quantity::Ratio,
        range: ANY,
        default: 1.1,
        typical: [0.8, 1.2],
        about: "shown over true",
    }],
    events: None,
    install: |device, p| {
        device.sensing.gain *= p[0];
    },
};
