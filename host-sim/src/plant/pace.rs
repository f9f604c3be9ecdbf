//! How exactly a plant is stepped.

use super::stribeck::Stride;

/// How finely stiff parts are stepped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Product of the fastest rate of a regime and the step.
    pub rate_step: f64,
    /// How far a step may go where friction falls with speed: it then misses 1e-4 of the fall.
    pub on_slope: Stride,
    /// A step is never divided further than this, however stiff the plant.
    pub most_divisions: f64,
    /// How closely an event is located, as a share of the step.
    pub event_tolerance: f64,
    /// Whether an event is located on a cubic through the ends of the step.
    pub cubic_events: bool,
    /// More events than this within one step are chatter of a degenerate plant (a static level below
    /// the sliding one, say): the rest of the step is then taken without looking for more.
    pub most_events: usize,
    /// Whether a link is stepped in closed form.
    pub closed_link: bool,
    /// Product of the fastest rate and the step up to which the midpoint rule suffices, if it ever does.
    pub glide_rate_step: Option<f64>,
}

/// A fourth-order step then errs by less than 1e-7 of what changes within it.
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
    closed_link: false,
    glide_rate_step: None,
};
/// The same where 1e-3 is enough, and what is stiffer than a sensor can show may go astray.
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
    closed_link: true,
    // The midpoint's frequency is off by a 24th of the square.
    glide_rate_step: Some(0.05),
};
/// Product of the fastest rate of all but a link and the step, where the link is stepped in closed form.
pub(super) const CLOSED_RATE_STEP: f64 = 0.2;
/// Of the link's natural rate and the step then: in a quarter of a period its flanks meet once at most.
pub(super) const CLOSED_LINK_STEP: f64 = 0.5 * core::f64::consts::PI;
/// How far a step of the midpoint rule may go where friction falls with speed.
pub(super) const MIDPOINT_ON_SLOPE: Stride = Stride {
    rate_step: 0.05,
    share: 0.1,
};
