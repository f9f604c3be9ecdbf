//! Start values of a compliant transmission between two masses.

use super::Evidence;
use super::start::geometric;
use crate::term::Term;
use host_sim::device::Device;

/// Share of the inertia, or of the friction, on each side of the transmission at the start.
pub(crate) const HALF: f64 = 0.5;
/// Share of the inertia below which a side of the transmission is taken as massless. It is half of the least typical share.
const LIGHTEST_SIDE: f64 = 0.05;

/// True if the model has friction that can be divided between the two sides.
pub(crate) fn has_friction(e: &Evidence<'_>) -> bool {
    let m = &e.device.mechanics;
    m.friction.highest_nm() > 0.0 || m.viscous > 0.0
}

/// Starts of a transmission between two masses. `sizes` is the range of its free size, of which `count` values in geometric progression
/// are tried, each with the position sensor on the motor side and on the load side.
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

/// True if the transmission is degenerate: its damper delays the return of the spring by more than a horizon, or one side has nearly no
/// inertia.
pub(crate) fn is_degenerate_link(device: &Device, horizon_s: f64) -> bool {
    device.mechanics.link.is_some_and(|link| {
        let lighter = link.load_share.min(1.0 - link.load_share);
        link.damping > horizon_s * link.stiffness || lighter < LIGHTEST_SIDE
    })
}
