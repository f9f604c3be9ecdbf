//! The sensor follows with play.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};

/// `y = x held within ± w/2`.
pub const KIND: Kind = Kind {
    name: "sensor_hysteresis",
    channel: Channel::Sensing,
    about: "The sensor follows with play",
    equation: "y = x held within ± w/2",
    parameters: &[Parameter {
        name: "width",
        quantity: Quantity::Position,
        range: NOT_NEGATIVE,
        default: 0.005,
        typical: [0.0005, 0.03],
        about: "of the play",
    }],
    events: None,
    install: |device, p| {
        device.sensing.hysteresis = p[0];
    },
};
