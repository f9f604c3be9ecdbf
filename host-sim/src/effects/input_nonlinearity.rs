//! A torque that is not proportional to the input.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, POSITIVE, Parameter, Quantity};
use crate::drive::InputCurve;

/// `T = ratio · g · U · sgn u · c(s) / c(1)`, `c(s) = s^p + (b − 1) max(s − s_k, 0)`, `s = max(|u| − w, 0) / (U − w)`: a dead zone
/// w followed by a power law, with another slope beyond the knee k, at which s is `s_k`. At the input `U` the torque is `g` times that
/// of the model. With p below 1 the gain falls with the input. With p = 2 the torque grows with the square. With p = 1 the curve is a
/// line whose slope changes by the factor b at the knee.
pub const KIND: Kind = Kind {
    name: "input_nonlinearity",
    channel: Channel::Actuation,
    about: "The torque is a nonlinear function of the input",
    equation: "T = ratio · g · U · sgn u · c(s) / c(1),  c(s) = s^p + (b − 1) max(s − s_k, 0),  s = max(|u| − w, 0) / (U − w)",
    sizes_from: "The sizes are assumptions: powers from a cube root to a cube (the thrust of a propeller is a square), and reference inputs of 3 to 30 % of the paddle's torque limit, 32.3 mN m at the motor.",
    parameters: &[
        Parameter {
            name: "gain",
            quantity: Quantity::Ratio,
            range: POSITIVE,
            default: 1.0,
            typical: [0.2, 5.0],
            about: "torque at the reference input over the model's torque there",
        },
        Parameter {
            name: "power",
            quantity: Quantity::Ratio,
            range: [0.05, 10.0],
            default: 1.0,
            typical: [0.3, 3.0],
            about: "power of the input beyond the dead zone",
        },
        Parameter {
            name: "dead_zone",
            quantity: Quantity::Input,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [0.0, 1e-3],
            about: "largest input without torque",
        },
        Parameter {
            name: "reference",
            quantity: Quantity::Input,
            range: POSITIVE,
            default: 5e-3,
            typical: [1e-3, 1e-2],
            about: "input to which the gain refers",
        },
        Parameter {
            name: "knee",
            quantity: Quantity::Input,
            range: POSITIVE,
            default: 2.5e-3,
            typical: [1e-3, 1e-2],
            about: "input k at which the slope changes",
        },
        Parameter {
            name: "slope_beyond",
            quantity: Quantity::Ratio,
            range: NOT_NEGATIVE,
            default: 1.0,
            // A flat slope is a saturation.
            typical: [0.2, 5.0],
            about: "slope beyond the knee over that of the line to it, 1 for no knee",
        },
    ],
    install: |device, p| {
        device.drive.curve = Some(InputCurve {
            gain: p[0],
            power: p[1],
            dead_zone: p[2],
            reference: p[3],
            knee: p[4],
            slope_beyond: p[5],
        });
    },
    ..PLAIN
};
