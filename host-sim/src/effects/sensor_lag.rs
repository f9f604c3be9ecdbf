//! A first-order lag, or two, of the position sensor.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, share};

/// `τ y' + y = x`. A second lag in series has this reading as its input.
pub const KIND: Kind = Kind {
    name: "sensor_lag",
    channel: Channel::Sensing,
    about: "The sensor follows through a first-order lag, or two",
    equation: "τ y' + y = x, or (τ d/dt + 1)² y = x",
    sizes_from: "The lab's Hall reading is 0.25 ms late; a low-pass of 100 Hz is 1.6 ms late, one of 8 Hz 20 ms.",
    parameters: &[
        Parameter {
            name: "time",
            quantity: Quantity::Time,
            range: NOT_NEGATIVE,
            default: 0.004,
            typical: [0.0005, 0.02],
            about: "time constant",
        },
        share("twice", "1 if another such lag follows on it"),
    ],
    install: |device, p| {
        device.sensing.lag_s = p[0];
        if p[1] > 0.5 {
            device.sensing.further_lag_s = p[0];
        }
    },
    ..PLAIN
};
