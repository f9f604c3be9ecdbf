//! An external object that touches or holds the joint for a time.

use super::{ANY, Channel, Events, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, instant};
use crate::device::{CONTACT, PUSH};
use crate::plant::Barrier;
use core::ops::Range;

/// Indices of the values of one contact: side, position, start and end.
const CONTACT_VALUES: Range<usize> = 2..6;

fn contacts(values: &[f64]) -> impl Iterator<Item = &[f64]> {
    values[CONTACT_VALUES.start..].chunks_exact(CONTACT_VALUES.len())
}

/// `T = −max(0, K d + D d')` during the contact.
pub const KIND: Kind = Kind {
    name: "contact",
    channel: Channel::Surroundings,
    about: "An external object touches the joint, or holds it, for a time",
    equation: "T = −max(0, K d + D d') while it is there; −K d − D d' if it holds",
    sizes_from: "The sizes are assumptions: from the light touch of a finger to a hard edge, anywhere within the travel of the paddle, ±0.61 rad.",
    parameters: &[
        Parameter {
            name: "stiffness",
            quantity: Quantity::Stiffness,
            range: NOT_NEGATIVE,
            default: 2.0,
            typical: [0.05, 50.0],
            about: "stiffness of the outside object",
        },
        Parameter {
            name: "damping",
            quantity: Quantity::Damping,
            range: NOT_NEGATIVE,
            default: 0.01,
            typical: [0.0, 0.1],
            about: "damping of the outside object",
        },
        Parameter {
            name: "side",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 1.0,
            typical: [-1.0, 1.0],
            about: "+1 if it stops positive motion, -1 if negative, 0 if it holds against both",
        },
        Parameter {
            name: "position",
            quantity: Quantity::Position,
            range: ANY,
            default: 0.1,
            typical: [-0.6, 0.6],
            about: "position at which contact begins, or at which it holds",
        },
        instant("from", 0.2),
        instant("to", 0.8),
    ],
    events: Some(Events {
        places: CONTACT_VALUES,
        most: PUSH - CONTACT,
        alone: |_| true,
        instants: Some([2, 3]),
    }),
    install: |device, p| {
        let [stiffness, damping] = [p[0], p[1]];
        let barriers = device.mechanics.barriers[CONTACT..PUSH].iter_mut();
        for (barrier, contact) in barriers.zip(contacts(p)) {
            *barrier = Some(Barrier {
                at: contact[1],
                side: if contact[0] == 0.0 {
                    0.0
                } else {
                    contact[0].signum()
                },
                stiffness,
                damping,
                torque_nm: 0.0,
                during_s: Some([contact[2], contact[3]]),
            });
        }
    },
    ..PLAIN
};
