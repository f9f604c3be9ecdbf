//! A constant torque that the model does not have.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity};

/// `T = ratio · u + T₀`.
pub const KIND: Kind = Kind {
    name: "torque_offset",
    channel: Channel::Actuation,
    about: "A constant torque that the model does not have",
    equation: "T = ratio · u + T₀",
    sizes_from: "The range is an assumption: up to a little more than the dry friction of the paddle's model, 15 mN m.",
    parameters: &[Parameter {
        name: "torque",
        quantity: Quantity::Torque,
        range: ANY,
        default: 0.005,
        typical: [-0.02, 0.02],
        about: "torque at the joint",
    }],
    install: |device, p| {
        device.mechanics.offset_nm += p[0];
    },
    ..PLAIN
};
