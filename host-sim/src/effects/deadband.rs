//! A dead band: small inputs give no torque.

use super::{Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, share};

/// `T = ratio · (u − (1 − j) (s ± 1) w)` beyond the edges `(s ± 1) w`, and 0 between them.
pub const KIND: Kind = Kind {
    name: "deadband",
    channel: Channel::Actuation,
    about: "Small inputs do nothing",
    equation: "T = ratio · (u − (1 − j) (s ± 1) w) beyond (s ± 1) w, else 0",
    sizes_from: "The width is an assumption: 0.15 to 3 % of the paddle's torque limit, 32.3 mN m at the motor.",
    parameters: &[
        Parameter {
            name: "width",
            quantity: Quantity::Input,
            range: NOT_NEGATIVE,
            default: 2e-4,
            typical: [5e-5, 1e-3],
            about: "largest input without torque: half of the width between the edges",
        },
        share(
            "jump",
            "share of the width by which the input jumps at its edge",
        ),
        share(
            "first",
            "1 if the dead band comes before the limit of the input, 0 if it comes after",
        ),
        Parameter {
            name: "skew",
            quantity: Quantity::Ratio,
            range: [-1.0, 1.0],
            default: 0.0,
            typical: [-1.0, 1.0],
            about: "distance of the middle from zero, as a share of the width",
        },
    ],
    install: |device, p| {
        device.drive.deadband = p[0];
        device.drive.deadband_jump = p[1];
        device.drive.deadband_first = p[2] > 0.5;
        device.drive.deadband_skew = p[3];
    },
    ..PLAIN
};
