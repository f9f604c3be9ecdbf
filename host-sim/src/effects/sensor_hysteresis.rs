//! Hysteresis of the position sensor.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};
use crate::hysteresis::Hysteresis;

/// `y = x − h`. With r = 0, h is limited to ± w/2 and otherwise keeps the reading constant. With r > 0, `h' = |x'| (sgn(x')
/// w/2 − h) / r`.
pub const KIND: Kind = Kind {
    name: "sensor_hysteresis",
    channel: Channel::Sensing,
    about: "The reading stays behind when the motion reverses",
    equation: "y = x − h, |h| ≤ w/2 for r = 0, or else h' = |x'| (sgn(x') w/2 − h)/r",
    sizes_from: "The width is an assumption: from two steps of the paddle's encoder (0.21 mrad each) to 1.7°.",
    parameters: &[
        Parameter {
            name: "width",
            quantity: Quantity::Position,
            range: NOT_NEGATIVE,
            default: 0.005,
            typical: [0.0005, 0.03],
            about: "w, distance between the curves of the two directions",
        },
        Parameter {
            name: "reach",
            quantity: Quantity::Position,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [0.0, 0.05],
            about: "r, way after a reversal over which the distance builds up; 0 for play",
        },
    ],
    install: |device, p| {
        device.sensing.hysteresis = Hysteresis {
            half_width: 0.5 * p[0],
            reach: p[1],
        };
    },
    ..PLAIN
};
