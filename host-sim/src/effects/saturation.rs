//! Large inputs are clipped earlier than the model knows, at once or little by little.

use super::{Channel, Kind, NOT_NEGATIVE, Parameter, Quantity, SHARE};
use crate::drive::Saturation;

/// `T = ratio · sign(u) s(|u|)`: with the limit L and the knee k, `s = v` up to `(1 − k) L`, `L` from `(1 + k) L` on, and
/// `v − (v − (1 − k) L)² / (4 k L)` between.
pub const KIND: Kind = Kind {
    name: "saturation",
    channel: Channel::Actuation,
    about: "Large inputs are clipped earlier than the model knows",
    equation: "T = ratio · clamp(u, ±limit), rounded off within ±knee · limit of the limit",
    parameters: &[
        Parameter {
            name: "limit",
            quantity: Quantity::Input,
            range: NOT_NEGATIVE,
            default: 0.01,
            typical: [0.003, 0.03],
            about: "largest input that acts",
        },
        Parameter {
            name: "knee",
            quantity: Quantity::Ratio,
            range: SHARE,
            default: 0.0,
            typical: [0.0, 1.0],
            about: "share of the limit, below and above it, over which the clipping sets in",
        },
    ],
    events: None,
    install: |device, p| {
        device.drive.saturation = Saturation {
            limit: p[0],
            knee: p[1],
        };
    },
};
