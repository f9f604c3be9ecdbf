//! The sensor jumps and stays off.

use super::{ANY, Channel, Kind, Parameter, Quantity};
use crate::sensing::Jump;

/// `y = x + Δ from t on`.
pub const KIND: Kind = Kind {
    name: "lost_counts",
    channel: Channel::Sensing,
    about: "The sensor jumps and stays off",
    equation: "y = x + Δ from t on",
    parameters: &[
        Parameter {
            name: "time",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.5,
            typical: [0.0, 1000.0],
            about: "of the session at which it jumps",
        },
        Parameter {
            name: "jump",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.05,
            typical: [-0.3, 0.3],
            about: "height of the jump",
        },
    ],
    install: |device, p| {
        // A counter that jumps more than once repeats the pair.
        let jumps = p.chunks_exact(2).map(|pair| Jump {
            at_s: pair[0],
            height: pair[1],
        });
        device.sensing.jumps.extend(jumps);
    },
};
