//! Gravity that differs from the model's in size or in the hanging position.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity, zero};

/// `T = −G sin(x − x_G)`.
pub const KIND: Kind = Kind {
    name: "gravity",
    channel: Channel::Mechanics,
    about: "A weight, or a hanging position, that differs from the model's",
    equation: "T = −G sin(x − x_G)",
    sizes_from: "The range is an assumption: up to seven times the weight times lever of the paddle's model, 14.6 mN m.",
    parameters: &[
        Parameter {
            name: "weight",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.03,
            typical: [0.0, 0.1],
            about: "weight times lever",
        },
        zero("position at which it hangs at rest"),
    ],
    install: |device, p| {
        device.mechanics.gravity = p[0];
        device.mechanics.gravity_zero = p[1];
    },
    ..PLAIN
};
