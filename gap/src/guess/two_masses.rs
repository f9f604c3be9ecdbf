//! Starts of a transmission between two masses.

use super::Evidence;
use super::start::geometric;
use crate::term::Term;
use host_sim::device::Device;

/// Share of the inertia, or of the friction, on either side where nothing is known of them.
pub(crate) const HALF: f64 = 0.5;
/// Share of the inertia below which a side is none: half of the least that is typical.
const LIGHTEST_SIDE: f64 = 0.05;

/// True if there is friction to share.
pub(crate) fn rubs(e: &Evidence<'_>) -> bool {
    let m = &e.device.mechanics;
    m.friction.highest_nm() > 0.0 || m.viscous > 0.0
}

/// Starts of a transmission between two masses, by the size of what is free in it: `count` values by equal ratios, each
/// with the position sensor on the motor's and on the load's side.
pub(crate) fn two_masses(
    sizes: [f64; 2],
    count: usize,
    starts: impl Fn(f64) -> Vec<Term>,
) -> Vec<Term> {
    let motor: Vec<Term> = geometric(sizes, count).flat_map(starts).collect();
    let load = motor.iter().cloned().map(|start| Term {
        sensor_on_load: true,
        ..start
    });
    let load: Vec<Term> = load.collect();
    [motor, load].concat()
}

/// True if what links two masses is none: a damper that takes longer than a prediction to let the spring come back, or a side
/// that weighs next to nothing.
pub(crate) fn is_no_link(device: &Device, horizon_s: f64) -> bool {
    device.mechanics.link.is_some_and(|link| {
        let lighter = link.load_share.min(1.0 - link.load_share);
        link.damping > horizon_s * link.stiffness || lighter < LIGHTEST_SIDE
    })
}
