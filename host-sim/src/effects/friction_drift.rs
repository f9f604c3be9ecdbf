//! Dry friction that changes over the session.

use super::{Channel, Kind, Parameter, Quantity};

/// `F = F_c (1 + d t) sign(v)`.
pub const KIND: Kind = Kind {
    name: "friction_drift",
    channel: Channel::Friction,
    about: "Dry friction that changes over the session",
    equation: "F = F_c (1 + d t) sign(v)",
    parameters: &[Parameter {
        name: "rate",
        quantity: Quantity::Frequency,
        default: 0.05,
        typical: [-0.1, 0.5],
        about: "relative growth per second",
    }],
    install: |device, p| {
        device.mechanics.friction.drift_per_s = p[0];
    },
};
