//! The sensor's curve is bent.

use super::{Channel, Kind, Parameter, Quantity};

/// `y = x + a x² + b x³`.
pub const KIND: Kind = Kind {
    name: "sensor_nonlinearity",
    channel: Channel::Sensing,
    about: "The sensor's curve is bent",
    equation: "y = x + a x² + b x³",
    parameters: &[
        Parameter {
            name: "quadratic",
            quantity: Quantity::PerPosition,
            default: 0.2,
            typical: [-0.5, 0.5],
            about: "of the curve",
        },
        Parameter {
            name: "cubic",
            quantity: Quantity::PerPositionSquared,
            default: 0.0,
            typical: [-2.0, 2.0],
            about: "of the curve",
        },
    ],
    install: |device, p| {
        device.sensing.quadratic = p[0];
        device.sensing.cubic = p[1];
    },
};
