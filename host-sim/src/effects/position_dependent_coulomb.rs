//! Dry friction that depends on the position.

use super::LEAST_LEVEL;
use super::{Channel, Kind, Parameter, Quantity};

/// `F = F_c max(0, l + a x + b x²) sign(v)`.
pub const KIND: Kind = Kind {
    name: "position_dependent_coulomb",
    channel: Channel::Friction,
    about: "Dry friction that depends on the position",
    equation: "F = F_c max(0, l + a x + b x²) sign(v)",
    parameters: &[
        Parameter {
            name: "slope",
            quantity: Quantity::PerPosition,
            default: 0.8,
            typical: [-2.0, 2.0],
            about: "growth with position, relative to the model's level",
        },
        Parameter {
            name: "curve",
            quantity: Quantity::PerPositionSquared,
            default: 0.0,
            typical: [0.0, 10.0],
            about: "growth with its square, likewise",
        },
        Parameter {
            name: "level",
            quantity: Quantity::Ratio,
            default: 1.0,
            typical: [0.5, 2.0],
            about: "at position zero, over the model's",
        },
    ],
    install: |device, p| {
        let level = p[2].max(LEAST_LEVEL);
        device.mechanics.friction.scale(level);
        device.mechanics.friction.position_slope = p[0] / level;
        device.mechanics.friction.position_curve = p[1] / level;
    },
};
