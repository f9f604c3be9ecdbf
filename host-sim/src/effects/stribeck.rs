//! Static friction above the sliding level.

use super::{Channel, Kind, PLAIN, POSITIVE, Parameter, Quantity, share};
use crate::plant::Stribeck;

/// Range of the exponent. With a lower one the slope at rest is infinite. With a higher one the level falls like a step.
const EXPONENTS: [f64; 2] = [1.0, 4.0];

/// Range of the static ratio. A level that rises with speed is not static friction and could be confused with drag.
const ABOVE: [f64; 2] = [1.0, f64::INFINITY];

/// `F = F_c [1 + (r − 1) (1 + t p)^(−1/t)] sign(v)`, p = |v/v_s|ⁿ.
pub const KIND: Kind = Kind {
    name: "stribeck",
    channel: Channel::Friction,
    about: "Static friction above the sliding level",
    equation: "F = F_c [1 + (r − 1) e(|v/v_s|^n)] sign(v), e(p) = exp(−p), with t exp(−ln(1 + t p)/t)",
    sizes_from: "The refit to the lab's logs has a static friction of 1.08 times the sliding level and falls over 0.1 rad/s; the range beyond is an assumption. The exponents 1 and 2 are the two usual forms (Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30, 1994).",
    parameters: &[
        Parameter {
            name: "static_ratio",
            quantity: Quantity::Ratio,
            range: ABOVE,
            default: 1.4,
            typical: [1.05, 2.5],
            about: "static level over the sliding level",
        },
        Parameter {
            name: "velocity",
            quantity: Quantity::Velocity,
            range: POSITIVE,
            default: 0.1,
            typical: [0.01, 2.0],
            about: "speed over which the level falls",
        },
        Parameter {
            name: "exponent",
            quantity: Quantity::Ratio,
            range: EXPONENTS,
            default: 2.0,
            typical: [1.0, 2.0],
            about: "n, steepness of the fall, 1 or more",
        },
        share(
            "tail",
            "t, tail of the fall: 0 for an exponential, 1 for a hyperbola",
        ),
    ],
    install: |device, p| {
        device.mechanics.friction.stribeck = Stribeck {
            ratio: p[0],
            velocity: p[1],
            exponent: p[2],
            tail: p[3],
        };
    },
    ..PLAIN
};
