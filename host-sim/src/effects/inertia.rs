//! An inertia that differs from the model's.

use super::{Channel, Kind, PLAIN, POSITIVE, Parameter, Quantity};

/// `J x'' = T`.
pub const KIND: Kind = Kind {
    name: "inertia",
    channel: Channel::Mechanics,
    about: "An inertia that differs from the model's",
    equation: "J x'' = T",
    sizes_from: "The range is an assumption: half to twice the inertia of the paddle's model, 5.755e-4 kg m².",
    parameters: &[Parameter {
        name: "inertia",
        quantity: Quantity::Inertia,
        range: POSITIVE,
        default: 7e-4,
        typical: [3e-4, 1.2e-3],
        about: "inertia that replaces the model's",
    }],
    install: |device, p| {
        device.mechanics.inertia = p[0];
    },
    ..PLAIN
};
