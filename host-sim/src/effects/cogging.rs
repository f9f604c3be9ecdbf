//! The torque ripples with position.

use super::{Channel, Kind, Parameter, Quantity};
use crate::plant::Cogging;

/// `T = A sin(n x + φ)`.
pub const KIND: Kind = Kind {
    name: "cogging",
    channel: Channel::Actuation,
    about: "The torque ripples with position",
    equation: "T = A sin(n x + φ)",
    parameters: &[
        Parameter {
            name: "amplitude",
            quantity: Quantity::Torque,
            default: 0.004,
            typical: [0.0005, 0.02],
            about: "of the ripple",
        },
        Parameter {
            name: "wave_number",
            quantity: Quantity::PerPosition,
            default: 90.0,
            typical: [6.0, 360.0],
            about: "2π over the period",
        },
        Parameter {
            name: "phase",
            quantity: Quantity::Angle,
            default: 0.0,
            typical: [-3.2, 3.2],
            about: "at position zero",
        },
    ],
    install: |device, p| {
        device.mechanics.cogging = Some(Cogging {
            amplitude_nm: p[0],
            wave_number: p[1],
            phase: p[2],
        });
    },
};
