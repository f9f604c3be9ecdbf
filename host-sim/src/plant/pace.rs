//! The accuracy with which a plant is stepped.

use super::stribeck::Stride;

/// Limits of a step and of the search for events.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Product of the fastest rate of a regime and the step.
    pub rate_step: f64,
    /// Longest step where friction falls with speed.
    pub on_slope: Stride,
    /// A step is never divided further than this, however stiff the plant.
    pub most_divisions: f64,
    /// Accuracy of the instant of an event, as a share of the step.
    pub event_tolerance: f64,
    /// True if an event is located on a cubic through the ends of the step.
    pub cubic_events: bool,
    /// Most events within one step. More of them are chatter of a degenerate plant, such as one with a static level
    /// below the sliding one; the rest of the step is then taken without a search.
    pub most_events: usize,
    /// Largest lag of a drive whose fading torque is given to the masses at once, as a share of the longest step that
    /// everything else allows.
    pub short_lag: f64,
    /// True if a link is stepped in closed form.
    pub closed_link: bool,
    /// Largest product of the fastest rate and the step for which the midpoint rule is used; `None` if it is never
    /// used.
    pub glide_rate_step: Option<f64>,
}

/// The error of a fourth-order step is below 1e-7 of the change within it.
pub(super) const EXACT: Pace = Pace {
    rate_step: 0.1,
    on_slope: Stride {
        rate_step: 0.1,
        share: 0.5,
    },
    most_divisions: 256.0,
    event_tolerance: 1e-13,
    cubic_events: false,
    most_events: 64,
    short_lag: 0.0,
    closed_link: false,
    glide_rate_step: None,
};
/// The error of a step is below 1e-3 of the change within it. A motion that is too fast for a sensor may be wrong.
pub(super) const QUICK: Pace = Pace {
    rate_step: 0.8,
    on_slope: Stride {
        rate_step: 0.8,
        share: 0.5,
    },
    most_divisions: 6.0,
    event_tolerance: 1e-4,
    cubic_events: true,
    most_events: 6,
    // The error is a twentieth of what the fading torque does in its lag. `tests/plant.rs` compares with exact steps.
    short_lag: 0.0625,
    closed_link: true,
    // The relative error of the midpoint rule's frequency is the square of this, over 24.
    glide_rate_step: Some(0.05),
};
/// Product of the step and the fastest rate without the link, where the link is stepped in closed form.
pub(super) const CLOSED_RATE_STEP: f64 = 0.2;
/// Product of the step and the link's natural rate, where the link is stepped in closed form. In a quarter of a period
/// the flanks meet once at most.
pub(super) const CLOSED_LINK_STEP: f64 = 0.5 * core::f64::consts::PI;
/// Longest step of the midpoint rule where friction falls with speed.
pub(super) const MIDPOINT_ON_SLOPE: Stride = Stride {
    rate_step: 0.05,
    share: 0.1,
};
