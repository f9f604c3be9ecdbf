//! The sensor's curve is bent.

use super::{Channel, Kind, Parameter, Quantity};

/// `y = x + a x² + b x³ + r sin(n x) + s (cos(n x) − 1)`.
pub const KIND: Kind = Kind {
    name: "sensor_nonlinearity",
    channel: Channel::Sensing,
    about: "The sensor's curve is bent",
    equation: "y = x + a x² + b x³ + r sin(n x) + s (cos(n x) − 1) + o",
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
        Parameter {
            name: "ripple_sine",
            quantity: Quantity::Position,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "of the curve",
        },
        Parameter {
            name: "ripple_cosine",
            quantity: Quantity::Position,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "of the curve",
        },
        Parameter {
            name: "wave_number",
            quantity: Quantity::PerPosition,
            default: 6.0,
            typical: [1.0, 60.0],
            about: "2π over the period of the ripple",
        },
        Parameter {
            name: "offset",
            quantity: Quantity::Position,
            default: 0.0,
            typical: [-0.02, 0.02],
            about: "of the reading at zero",
        },
    ],
    install: |device, p| {
        device.sensing.quadratic = p[0];
        device.sensing.cubic = p[1];
        device.sensing.ripple = [p[2], p[3]];
        device.sensing.wave_number = p[4];
        device.sensing.offset = p[5];
    },
};
