//! Friction that grows with speed.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity};

/// `F = B v`.
pub const KIND: Kind = Kind {
    name: "viscous",
    channel: Channel::Friction,
    about: "Friction that grows with speed",
    equation: "F = B v",
    sizes_from: "The lab's nominal model has 0.18 mN m s/rad, the refit to its logs 3.9 mN m s/rad. The range goes to five times that.",
    parameters: &[Parameter {
        name: "coefficient",
        quantity: Quantity::Damping,
        range: NOT_NEGATIVE,
        default: 4e-3,
        typical: [0.0, 2e-2],
        about: "coefficient that replaces the model's",
    }],
    install: |device, p| {
        device.mechanics.viscous = p[0];
    },
    ..PLAIN
};
