//! An external torque for a short time.

use super::{ANY, Channel, Events, Kind, PLAIN, Parameter, Quantity, instant};
use crate::device::PUSH;
use crate::plant::{BARRIERS, Barrier};
use core::ops::Range;

/// Indices of the values of one push: torque, start and end.
const PUSHES: Range<usize> = 0..3;

/// `T = T₀` between two instants.
pub const KIND: Kind = Kind {
    name: "push",
    channel: Channel::Surroundings,
    about: "An external torque acts for a short time",
    equation: "T = T0 from one instant to another",
    sizes_from: "The torque is an assumption: 1 N m is a hand that pushes with 15 N at the paddle's lever of 65 mm.",
    parameters: &[
        Parameter {
            name: "torque",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.05,
            typical: [-1.0, 1.0],
            about: "torque of the push",
        },
        instant("from", 0.2),
        instant("to", 0.4),
    ],
    events: Some(Events {
        places: PUSHES,
        most: BARRIERS - PUSH,
        alone: |_| true,
        instants: Some([1, 2]),
    }),
    install: |device, p| {
        let places = device.mechanics.barriers[PUSH..].iter_mut();
        for (place, push) in places.zip(p.chunks_exact(PUSHES.len())) {
            *place = Some(Barrier {
                at: 0.0,
                side: 0.0,
                stiffness: 0.0,
                damping: 0.0,
                torque_nm: push[0],
                during_s: Some([push[1], push[2]]),
            });
        }
    },
    ..PLAIN
};
