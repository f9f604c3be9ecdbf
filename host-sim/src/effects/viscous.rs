//! Viscous friction that differs from the model's.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};

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
        range: ANY,
        default: 4e-3,
        typical: [0.0, 2e-2],
        about: "coefficient that replaces the model's; negative if the drive adds torque with speed",
    }],
    install: |device, p| {
        device.mechanics.viscous = p[0];
    },
    ..PLAIN
};
