//! Lost counts of the sensor, at one instant or continuously above a speed.

use super::{ANY, Channel, Events, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, SHARE};
use crate::sensing::{Jump, Overspeed};
use core::ops::Range;

/// Indices of the values of one jump: time and height.
const JUMP: Range<usize> = 0..2;
/// Indices of the share that is lost above a speed, and of that speed.
const SHARE_LOST: usize = 2;
const FROM_SPEED: usize = 3;

/// `y = x + Δ` from the instant t, and `y' = x' − q (x' − v sgn x')` where `|x'| > v`.
pub const KIND: Kind = Kind {
    name: "lost_counts",
    channel: Channel::Sensing,
    about: "The sensor loses counts, at one instant or at high speed",
    equation: "y = x + Δ from t on, y' = x' − q (x' − v sgn x') where |x'| > v",
    sizes_from: "The sizes are assumptions: jumps of up to half of the way from the middle of the paddle's travel to its end, 0.61 rad.",
    parameters: &[
        Parameter {
            name: "time",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.5,
            typical: [0.0, 1000.0],
            about: "time of the jump in the session",
        },
        Parameter {
            name: "jump",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.05,
            typical: [-0.3, 0.3],
            about: "height of the jump",
        },
        Parameter {
            name: "share",
            quantity: Quantity::Ratio,
            range: SHARE,
            default: 0.0,
            typical: [0.0, 0.5],
            about: "share of the speed beyond `speed` that is lost",
        },
        Parameter {
            name: "speed",
            quantity: Quantity::Velocity,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [1.0, 20.0],
            about: "speed up to which nothing is lost",
        },
    ],
    events: Some(Events {
        places: JUMP,
        most: usize::MAX,
        alone: |p| p[SHARE_LOST] == 0.0,
        instants: None,
    }),
    install: |device, p| {
        let (once, again) = p.split_at(KIND.parameters.len());
        let events = [&once[JUMP], again].concat();
        let jumps = events.chunks_exact(JUMP.len()).map(|event| Jump {
            at_s: event[0],
            height: event[1],
        });
        device.sensing.jumps.extend(jumps);
        if once[SHARE_LOST] > 0.0 {
            device.sensing.overspeed = Overspeed {
                share: once[SHARE_LOST],
                speed: once[FROM_SPEED],
            };
        }
    },
    ..PLAIN
};
