//! Dry friction that depends on the position.

use super::{ANY, Channel, Kind, LEVEL, PLAIN, POSITIVE, Parameter, Quantity, WAVE_NUMBER};
use crate::plant::Spot;
use crate::ripple::Ripple;

/// Below, a bell would have a cusp; above, its flanks are walls.
const SPOT_EXPONENTS: [f64; 2] = [Spot::BELL, 32.0];

/// `F = F_c max(0, l + a x + b x² + r sin(n x) + s (cos(n x) − 1) + h exp(−|(x − c)/w|^m)) sign(v)`.
pub const KIND: Kind = Kind {
    name: "position_dependent_coulomb",
    channel: Channel::Friction,
    about: "Dry friction that depends on the position",
    equation: "F = F_c max(0, l + a x + b x² + r sin(n x) + s (cos(n x) − 1) + h exp(−|(x − c)/w|^m)) sign(v)",
    sizes_from: "Judgement. On one paddle of the lab dry friction grows with the angle.",
    parameters: &[
        Parameter {
            name: "slope",
            quantity: Quantity::PerPosition,
            range: ANY,
            default: 0.8,
            typical: [-2.0, 2.0],
            about: "growth with position, relative to the model's level",
        },
        Parameter {
            name: "curve",
            quantity: Quantity::PerPositionSquared,
            range: ANY,
            default: 0.0,
            typical: [0.0, 10.0],
            about: "growth with its square, likewise",
        },
        Parameter {
            name: "level",
            quantity: Quantity::Ratio,
            range: LEVEL,
            default: 1.0,
            typical: [0.5, 2.0],
            about: "at position zero, over the model's",
        },
        Parameter {
            name: "ripple_sine",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 0.5],
            about: "of a pulley that is not round, relative to the model's level",
        },
        Parameter {
            name: "ripple_cosine",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 0.5],
            about: "likewise",
        },
        WAVE_NUMBER,
        Parameter {
            name: "spot",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 3.0],
            about: "of a spot that rubs, relative to the model's level",
        },
        Parameter {
            name: "spot_position",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.6, 0.6],
            about: "its middle",
        },
        Parameter {
            name: "spot_width",
            quantity: Quantity::Position,
            range: POSITIVE,
            default: 0.1,
            typical: [0.02, 0.3],
            about: "half of it, down to 1/e",
        },
        Parameter {
            name: "spot_exponent",
            quantity: Quantity::Ratio,
            range: SPOT_EXPONENTS,
            default: Spot::BELL,
            typical: [2.0, 10.0],
            about: "m, how steep its flanks are: 2 a bell, more a band",
        },
    ],
    install: |device, p| {
        let level = p[2];
        let friction = &mut device.mechanics.friction;
        friction.scale(level);
        friction.position_slope = p[0] / level;
        friction.position_curve = p[1] / level;
        friction.position_ripple = Ripple {
            sine: p[3] / level,
            cosine: p[4] / level,
            wave_number: p[5],
        };
        friction.position_spot = Spot {
            height: p[6] / level,
            position: p[7],
            width: p[8],
            exponent: p[9],
        };
    },
    ..PLAIN
};
