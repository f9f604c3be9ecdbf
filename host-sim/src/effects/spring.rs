//! A spring towards a position, which may harden.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, zero};

/// `T = −K (1 + h (x − x_K)²) (x − x_K)`.
pub const KIND: Kind = Kind {
    name: "spring",
    channel: Channel::Mechanics,
    about: "A spring towards a position",
    equation: "T = −K (1 + h (x − x_K)²) (x − x_K)",
    sizes_from: "The stiffness is an assumption: from a third of the slope of the paddle's gravity torque at rest, 15 mN m/rad, to thirty times that slope.",
    parameters: &[
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 0.05,
            typical: [0.005, 0.5],
            about: "stiffness of the spring",
        },
        zero("position at which it is relaxed"),
        Parameter {
            name: "hardening",
            quantity: Quantity::PerPositionSquared,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [0.0, 2.0],
            about: "hardening of the spring away from its relaxed position",
        },
    ],
    install: |device, p| {
        device.mechanics.stiffness = p[0];
        device.mechanics.stiffness_zero = p[1];
        device.mechanics.hardening = p[2];
    },
    ..PLAIN
};
