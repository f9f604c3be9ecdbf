//! A limited rate of the acting input, for example of a servo with a speed limit.

use super::{Channel, Kind, PLAIN, POSITIVE, Parameter, Quantity};

/// `|dw/dt| ≤ rate, T = ratio · w`.
pub const KIND: Kind = Kind {
    name: "rate_limit",
    channel: Channel::Actuation,
    about: "The acting input changes no faster than a rate",
    equation: "T = ratio · w, where w follows u with |w'| ≤ rate",
    sizes_from: "The rate is an assumption: the motor comes from rest to the paddle's torque limit, 32.3 mN m, within 3 s at the slowest and within 3 ms at the fastest.",
    parameters: &[Parameter {
        name: "rate",
        quantity: Quantity::InputRate,
        range: POSITIVE,
        default: 0.05,
        typical: [0.01, 10.0],
        about: "fastest change of the acting input",
    }],
    install: |device, p| {
        device.drive.rate_limit = p[0];
    },
    ..PLAIN
};
