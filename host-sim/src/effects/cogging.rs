//! A torque ripple that depends on the position.

use super::{ANY, Channel, Events, Kind, PLAIN, POSITIVE, Parameter, Quantity};
use crate::plant::{Cogging, FURTHER, Wave};
use core::ops::Range;

/// Indices of the values of one wave: amplitude, wave number and phase.
const WAVES: Range<usize> = 0..3;
/// Number of values of an effect with a single wave.
const SINGLE: usize = 5;

fn wave(values: &[f64]) -> Wave {
    Wave {
        amplitude_nm: values[0],
        wave_number: values[1],
        phase: values[2],
    }
}

/// `T = A sin θ + a sin 2θ + b cos 2θ` with `θ = n x + φ`, and further waves.
pub const KIND: Kind = Kind {
    name: "cogging",
    channel: Channel::Actuation,
    about: "The torque has a ripple over the position",
    equation: "T = A sin θ + a sin 2θ + b cos 2θ + A2 sin(n2 x + φ2) + …, θ = n x + φ",
    sizes_from: "The waves seen on a recording of the lab's paddle have up to 3 mN m; the range beyond is an assumption. A wave number of 360 is a motor with 24 waves a turn behind the gear of 15.",
    parameters: &[
        Parameter {
            name: "amplitude",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.004,
            typical: [0.0005, 0.02],
            about: "amplitude of the ripple",
        },
        Parameter {
            name: "wave_number",
            quantity: Quantity::PerPosition,
            range: POSITIVE,
            default: 90.0,
            typical: [6.0, 360.0],
            about: "2π over the period of the ripple",
        },
        Parameter {
            name: "phase",
            quantity: Quantity::Angle,
            range: ANY,
            default: 0.0,
            typical: [-3.2, 3.2],
            about: "phase at position zero",
        },
        Parameter {
            name: "second_sine",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.0,
            typical: [-0.002, 0.002],
            about: "sine part of the first wave's second harmonic",
        },
        Parameter {
            name: "second_cosine",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.0,
            typical: [-0.002, 0.002],
            about: "cosine part of the first wave's second harmonic",
        },
    ],
    events: Some(Events {
        places: WAVES,
        most: 1 + FURTHER,
        alone: |_| false,
        instants: None,
    }),
    install: |device, p| {
        let mut further = [Wave::NONE; FURTHER];
        let more = p.get(SINGLE..).unwrap_or_default();
        for (place, values) in further.iter_mut().zip(more.chunks_exact(WAVES.len())) {
            *place = wave(values);
        }
        device.mechanics.cogging = Some(Cogging {
            first: wave(p),
            second_nm: [p[3], p[4]],
            further,
        });
    },
    ..PLAIN
};
