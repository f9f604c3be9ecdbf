//! A limited rate of change of the acting input, as of a servo with a speed limit.

use super::{Channel, Kind, PLAIN, POSITIVE, Parameter, Quantity};

/// `|dw/dt| ≤ rate, T = ratio · w`.
pub const KIND: Kind = Kind {
    name: "rate_limit",
    channel: Channel::Actuation,
    about: "What acts of the input changes no faster than a rate",
    equation: "T = ratio · w, where w follows u with |w'| ≤ rate",
    sizes_from: "Judgement: the whole torque limit of the paddle, 32.3 mN m at the motor, within 3 s or within 3 ms.",
    parameters: &[Parameter {
        name: "rate",
        quantity: Quantity::InputRate,
        range: POSITIVE,
        default: 0.05,
        typical: [0.01, 10.0],
        about: "fastest change of what acts of the input",
    }],
    install: |device, p| {
        device.drive.rate_limit = p[0];
    },
    ..PLAIN
};
