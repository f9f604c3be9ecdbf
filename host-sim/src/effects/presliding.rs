//! Dry friction with elastic presliding.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, POSITIVE, Parameter, Quantity};
use crate::plant::Presliding;

/// Range of the exponent. A lower one gives a corner that no solver follows. With a higher one the bristles hardly slide.
const EXPONENTS: [f64; 2] = [0.05, 4.0];

/// Largest elastic share. With a larger one the bristles are only a spring.
const MOST_ELASTIC: f64 = 0.95;

/// `z' = v (1 − s)^n, F = F_c z / z_s + σ z'`. s is the fraction of the way to sliding. The bristles are purely elastic
/// below a share of the sliding deflection and on the way back.
pub const KIND: Kind = Kind {
    name: "presliding",
    channel: Channel::Friction,
    about: "Dry friction with elastic motion before it slides",
    equation: "z' = v (1 − s)^n, F = F_c z / z_s + σ z', s = z sgn v / z_s, \
               with e above 0 max(0, (z sgn v / z_s − e) / (1 − e))",
    sizes_from: "The distance is an assumption: from two steps of the paddle's encoder (0.21 mrad each) to 1.7°. The exponent 1 is that of the LuGre model (Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40, 1995).",
    parameters: &[
        Parameter {
            name: "distance",
            quantity: Quantity::Position,
            range: POSITIVE,
            default: 0.005,
            typical: [0.0005, 0.03],
            about: "deflection at which it slides",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 1e-3,
            typical: [0.0, 2e-2],
            about: "damping of the deflection",
        },
        Parameter {
            name: "exponent",
            quantity: Quantity::Ratio,
            range: EXPONENTS,
            default: 1.0,
            typical: [0.1, 1.5],
            about: "n, 1 for the LuGre model; with less the bristles start to slide more suddenly",
        },
        Parameter {
            name: "elastic",
            quantity: Quantity::Ratio,
            range: [0.0, MOST_ELASTIC],
            default: 0.0,
            typical: [0.2, 0.8],
            about: "e, share of the distance up to which it is purely elastic",
        },
    ],
    install: |device, p| {
        device.mechanics.presliding = Some(Presliding {
            distance: p[0],
            damping: p[1],
            exponent: p[2],
            elastic: p[3],
        });
    },
    ..PLAIN
};
