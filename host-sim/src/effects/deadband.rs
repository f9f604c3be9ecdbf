//! Small inputs do nothing.

use super::{Channel, Kind, Parameter, Quantity};

/// `T = ratio · sign(u) max(0, |u| − w)`.
pub const KIND: Kind = Kind {
    name: "deadband",
    channel: Channel::Actuation,
    about: "Small inputs do nothing",
    equation: "T = ratio · sign(u) max(0, |u| − w)",
    parameters: &[Parameter {
        name: "width",
        quantity: Quantity::Input,
        default: 2e-4,
        typical: [5e-5, 1e-3],
        about: "input up to which nothing happens",
    }],
    install: |device, p| {
        device.drive.deadband = p[0].max(0.0);
    },
};
