//! A hard stop within the travel.

use super::{ANY, Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `T = −max(0, K d + D d')` beyond the stop.
pub const KIND: Kind = Kind {
    name: "end_stop",
    channel: Channel::Mechanics,
    about: "A hard stop within the travel",
    equation: "T = −max(0, K d + D d') beyond the stop",
    sizes_from: "The places are assumptions within the travel of the paddle, which is ±0.61 rad by the lab's report. The stiffness and the damping are assumptions, too.",
    parameters: &[
        Parameter {
            name: "lower",
            quantity: Quantity::Position,
            range: ANY,
            default: -0.4,
            typical: [-0.6, -0.1],
            about: "position of the lower stop",
        },
        Parameter {
            name: "upper",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.4,
            typical: [0.1, 0.6],
            about: "position of the upper stop",
        },
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 20.0,
            typical: [1.0, 100.0],
            about: "stiffness of both stops; a stop at the position of a stop of the model keeps the model's stiffness",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 0.02,
            typical: [0.0, 0.1],
            about: "damping of both stops in contact",
        },
    ],
    install: |device, p| {
        device.set_stops([p[0], p[1]], p[2], p[3]);
    },
    ..PLAIN
};
