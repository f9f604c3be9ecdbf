//! Something outside pushes back for a while, or holds.

use super::{ANY, Channel, Kind, NOT_NEGATIVE, Parameter, Quantity};
use crate::device::CONTACT;
use crate::plant::Barrier;

/// `T = −max(0, K d + D d') while it is there`.
pub const KIND: Kind = Kind {
    name: "contact",
    channel: Channel::Surroundings,
    about: "Something outside pushes back for a while, or holds",
    equation: "T = −max(0, K d + D d') while it is there; −K d − D d' if it holds",
    parameters: &[
        Parameter {
            name: "position",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.1,
            typical: [-0.6, 0.6],
            about: "where it begins, or holds",
        },
        Parameter {
            name: "side",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 1.0,
            typical: [-1.0, 1.0],
            about: "+1 against positive motion, -1 against negative, 0 holds against both",
        },
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 2.0,
            typical: [0.05, 50.0],
            about: "of what pushes",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 0.01,
            typical: [0.0, 0.1],
            about: "of what pushes",
        },
        Parameter {
            name: "from",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.2,
            typical: [0.0, 1000.0],
            about: "of the session",
        },
        Parameter {
            name: "to",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.8,
            typical: [0.0, 1000.0],
            about: "of the session",
        },
    ],
    install: |device, p| {
        device.mechanics.barriers[CONTACT] = Some(Barrier {
            at: p[0],
            side: if p[1] == 0.0 { 0.0 } else { p[1].signum() },
            stiffness: p[2],
            damping: p[3],
            during_s: Some([p[4], p[5]]),
        });
    },
};
