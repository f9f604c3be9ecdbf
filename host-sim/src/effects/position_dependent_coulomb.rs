//! Dry friction that depends on the position.

use super::{ANY, Channel, Kind, LEVEL, PLAIN, POSITIVE, Parameter, Quantity, WAVE_NUMBER};
use crate::plant::Spot;
use crate::ripple::Ripple;

/// Range of the exponent of a spot. A lower exponent gives a cusp, a higher one vertical flanks.
const SPOT_EXPONENTS: [f64; 2] = [Spot::BELL, 32.0];

/// `F = F_c max(0, l + a x + b x² + r sin(n x) + s (cos(n x) − 1) + h exp(−|(x − c)/w|^m)) sign(v)`.
pub const KIND: Kind = Kind {
    name: "position_dependent_coulomb",
    channel: Channel::Friction,
    about: "Dry friction that depends on the position",
    equation: "F = F_c max(0, l + a x + b x² + r sin(n x) + s (cos(n x) − 1) + h exp(−|(x − c)/w|^m)) sign(v)",
    sizes_from: "On one paddle of the lab dry friction grows with the angle. The sizes are assumptions: at the end of the travel, 0.61 rad, the slope alone more than doubles the level or takes all of it.",
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
            about: "growth with the square of the position, relative to the model's level",
        },
        Parameter {
            name: "level",
            quantity: Quantity::Ratio,
            range: LEVEL,
            default: 1.0,
            typical: [0.5, 2.0],
            about: "level at position zero, over the model's",
        },
        Parameter {
            name: "ripple_sine",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 0.5],
            about: "sine part of a ripple, as of a pulley that is not round, relative to the model's level",
        },
        Parameter {
            name: "ripple_cosine",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 0.5],
            about: "cosine part of the ripple, relative to the model's level",
        },
        WAVE_NUMBER,
        Parameter {
            name: "spot",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 3.0],
            about: "height of a spot that rubs, relative to the model's level",
        },
        Parameter {
            name: "spot_position",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.0,
            typical: [-0.6, 0.6],
            about: "position of the middle of the spot",
        },
        Parameter {
            name: "spot_width",
            quantity: Quantity::Position,
            range: POSITIVE,
            default: 0.1,
            typical: [0.02, 0.3],
            about: "half of the width of the spot, down to 1/e",
        },
        Parameter {
            name: "spot_exponent",
            quantity: Quantity::Ratio,
            range: SPOT_EXPONENTS,
            default: Spot::BELL,
            typical: [2.0, 10.0],
            about: "m, steepness of the flanks of the spot: 2 for a bell, more for a band",
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
