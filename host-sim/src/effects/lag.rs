//! A first-order lag, or two, between input and torque.

use super::{ANY, Channel, Kind, PLAIN, Parameter, Quantity, share};

/// `τ T' + T = ratio · u`. A second lag in series has this torque as its input.
pub const KIND: Kind = Kind {
    name: "lag",
    channel: Channel::Actuation,
    about: "The torque follows the input through a first-order lag, or two",
    equation: "τ T' + T = ratio · u, or (τ d/dt + 1)² T = ratio · u",
    sizes_from: "The shortest is near one control period of the lab's board, 0.35 ms. The longest is an assumption for a slow drive.",
    parameters: &[
        Parameter {
            name: "time",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.003,
            typical: [0.0005, 0.02],
            about: "time constant in addition to the model's; negative if the model's is too long",
        },
        share(
            "apart",
            "1 if it is a second lag in series with the model's, 0 if it adds to the model's time constant",
        ),
        share("twice", "1 if it is both"),
    ],
    install: |device, p| {
        let [is_apart, is_twice] = [p[1] > 0.5, p[2] > 0.5];
        if is_apart || is_twice {
            device.drive.further_lag_s = p[0].max(0.0);
        }
        if !is_apart || is_twice {
            device.drive.lag_s = (device.drive.lag_s + p[0]).max(0.0);
        }
    },
    ..PLAIN
};
