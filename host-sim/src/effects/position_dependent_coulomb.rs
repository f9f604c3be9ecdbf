//! Dry friction that depends on the position.

use super::{Channel, Kind, Parameter, Quantity};

/// `F = F_c max(0, 1 + a x + b x²) sign(v)`.
pub const KIND: Kind = Kind {
    name: "position_dependent_coulomb",
    channel: Channel::Friction,
    about: "Dry friction that depends on the position",
    equation: "F = F_c max(0, 1 + a x + b x²) sign(v)",
    parameters: &[
        Parameter {
            name: "slope",
            quantity: Quantity::PerPosition,
            default: 0.8,
            typical: [-2.0, 2.0],
            about: "relative growth with position",
        },
        Parameter {
            name: "curve",
            quantity: Quantity::PerPositionSquared,
            default: 0.0,
            typical: [0.0, 10.0],
            about: "relative growth with its square",
        },
    ],
    install: |device, p| {
        device.mechanics.friction.position_slope = p[0];
        device.mechanics.friction.position_curve = p[1];
    },
};
