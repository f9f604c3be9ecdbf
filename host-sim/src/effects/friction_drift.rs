//! Dry friction that changes over the session.

use super::{ANY, Channel, Kind, NOT_NEGATIVE, PLAIN, Parameter, Quantity, share};
use crate::plant::Drift;

/// `F = F_c (1 + d t) sign(v)`. With a time constant τ, t is replaced by τ (1 − e^(−t/τ)), or by −τ e^(−t/τ) if the level is
/// the settled one. A step adds to this from its instant on.
pub const KIND: Kind = Kind {
    name: "friction_drift",
    channel: Channel::Friction,
    about: "Dry friction that changes over the session",
    equation: "F = F_c (1 + d τ (1 − exp(−t/τ))) sign(v), settled F_c (1 − d τ exp(−t/τ)) sign(v), without τ F_c (1 + d t) sign(v); with a step s F_c more from its instant on",
    sizes_from: "The sizes are assumptions for recordings of up to a minute: from friction that halves within 5 s to friction that grows by half each second.",
    parameters: &[
        Parameter {
            name: "rate",
            quantity: Quantity::Frequency,
            range: ANY,
            default: 0.05,
            typical: [-0.1, 0.5],
            about: "growth per second at the start, relative to the model's level",
        },
        Parameter {
            name: "settling",
            quantity: Quantity::Time,
            range: NOT_NEGATIVE,
            default: 0.0,
            typical: [0.0, 20.0],
            about: "time constant with which it settles; 0 if it does not settle",
        },
        share(
            "anew",
            "1 if it restarts with the clock of each run, 0 if it continues through the session",
        ),
        share(
            "settled",
            "1 if the model's level is the settled one, 0 if it is the one at the start",
        ),
        Parameter {
            name: "step",
            quantity: Quantity::Ratio,
            range: ANY,
            default: 0.0,
            typical: [-0.5, 0.5],
            about: "height of a step, relative to the model's level",
        },
        Parameter {
            name: "step_at",
            quantity: Quantity::Time,
            range: ANY,
            default: 0.0,
            typical: [0.0, 20.0],
            about: "time of the step after the start",
        },
    ],
    install: |device, p| {
        device.mechanics.friction.drift = Some(Drift {
            rate_per_s: p[0],
            settling_s: Some(p[1]).filter(|settling_s| *settling_s > 0.0),
            step: p[4],
            step_s: p[5],
            start_s: 0.0,
            anew: p[2] > 0.5,
            settled: p[3] > 0.5,
        });
    },
    ..PLAIN
};
