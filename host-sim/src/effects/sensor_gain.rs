//! A gain error of the position sensor.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity, zero};

/// `y = z + g (x − z)`.
pub const KIND: Kind = Kind {
    name: "sensor_gain",
    channel: Channel::Sensing,
    about: "The sensor shows more or less than the true motion",
    equation: "y = z + g (x − z)",
    sizes_from: "The lab's Hall sensor showed 1.12 times the way gone. The range beyond is an assumption.",
    parameters: &[
        Parameter {
            name: "gain",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 1.1,
            typical: [0.8, 1.2],
            about: "shown motion over true motion",
        },
        zero("z, position at which the reading is right"),
    ],
    install: |device, p| {
        device.sensing.gain *= p[0];
        device.sensing.offset += (1.0 - p[0]) * p[1];
    },
    ..PLAIN
};
