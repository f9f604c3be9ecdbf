//! A limit of the input that differs from the model's, with a sharp or a rounded transition.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, share};
use crate::drive::Saturation;

/// `T = ratio · sign(u) s(|u|)` with the limit L and the knee k. `s = v` up to `(1 − k) L`, `s = L` from `(1 + k) L`, and `v
/// − (v − (1 − k) L)² / (4 k L)` between. With a no-load speed v₀, L is `L₀ (1 − x'/v₀)` for positive inputs and `L₀ (1 +
/// x'/v₀)` for negative ones, in addition to the model's limit. Without v₀, a limit above the model's replaces it.
pub const KIND: Kind = Kind {
    name: "saturation",
    channel: Channel::Actuation,
    about: "Large inputs are clipped at another limit than the model's",
    equation: "T = ratio · clamp(u, ±limit), rounded off within ±knee · limit of the limit, which falls to 0 at no_load",
    sizes_from: "The limit is an assumption: from a tenth of the paddle's torque limit, 32.3 mN m at the motor, to nearly all of it. At 24 V the paddle's motor, of 53.8 mN m/A, turns the paddle by at most 30 rad/s.",
    parameters: &[
        Parameter {
            name: "limit",
            quantity: Quantity::Input,
            range: NOT_NEGATIVE,
            default: 0.01,
            typical: [0.003, 0.03],
            about: "largest input that acts",
        },
        share(
            "knee",
            "width of the rounded transition on either side of the limit, as a share of the limit",
        ),
        Parameter {
            name: "no_load",
            quantity: Quantity::Velocity,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [0.0, 100.0],
            about: "speed at which the limit is 0, as under a limited voltage; 0 if the limit is the same at any speed",
        },
    ],
    install: |device, p| {
        let falls = p[2] > 0.0;
        if !falls {
            device.drive.limit = device.drive.limit.max(p[0]);
        }
        device.drive.saturation = Saturation {
            limit: p[0],
            knee: p[1],
            no_load_velocity: if falls { p[2] } else { f64::INFINITY },
        };
    },
    ..PLAIN
};
