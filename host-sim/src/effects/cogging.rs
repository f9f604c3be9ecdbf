//! The torque ripples with position.

use super::{ANY, Channel, Kind, POSITIVE, Parameter, Quantity};
use crate::plant::Cogging;

/// `T = A sin θ + a sin 2θ + b cos 2θ` with `θ = n x + φ`.
pub const KIND: Kind = Kind {
    name: "cogging",
    channel: Channel::Actuation,
    about: "The torque ripples with position",
    equation: "T = A sin θ + a sin 2θ + b cos 2θ, θ = n x + φ",
    parameters: &[
        Parameter {
            name: "amplitude",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.004,
            typical: [0.0005, 0.02],
            about: "of the ripple",
        },
        Parameter {
            name: "wave_number",
            quantity: Quantity::PerPosition,
            range: POSITIVE,
            default: 90.0,
            typical: [6.0, 360.0],
            about: "2π over the period",
        },
        Parameter {
            name: "phase",
            quantity: Quantity::Angle,
            range: ANY,
            default: 0.0,
            typical: [-3.2, 3.2],
            about: "at position zero",
        },
        Parameter {
            name: "second_sine",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.0,
            typical: [-0.002, 0.002],
            about: "of the second harmonic",
        },
        Parameter {
            name: "second_cosine",
            quantity: Quantity::Torque,
            range: ANY,
            default: 0.0,
            typical: [-0.002, 0.002],
            about: "of the second harmonic",
        },
    ],
    events: None,
    install: |device, p| {
        device.mechanics.cogging = Some(Cogging {
            amplitude_nm: p[0],
            wave_number: p[1],
            phase: p[2],
            second_nm: [p[3], p[4]],
        });
    },
};
