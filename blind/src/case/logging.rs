//! Draws the sensors and the sampling of a device's log.

use recording::{Sensor, low_pass_gain};

use super::FINE_STEPS;
use crate::draw::Draw;
use crate::scenario::Plant;
use crate::session::Logging;

/// Draws how `plant` is logged. A second position sensor is more likely if `informative`, that is, if it helps to identify
/// the hidden effect. There is none if the device has separate motor and load inertias (`two_sided`).
pub(super) fn logging(
    draw: &mut Draw,
    plant: &Plant,
    informative: bool,
    two_sided: bool,
) -> Logging {
    let coarser = draw.log_uniform(1.0, 4.0);
    let second = Sensor {
        resolution: 0.0,
        noise: coarser * plant.sensor.noise.max(plant.sensor.resolution / 3.0),
        cutoff_hz: None,
    };
    let has_second = draw.chance(if informative { 0.4 } else { 0.15 }) && !two_sided;
    Logging {
        sensor: plant.sensor,
        logged_gain: low_pass_gain(plant.sensor.cutoff_hz, plant.tick_s),
        filters_noise: draw.chance(0.7),
        second: has_second.then_some(second),
        horizon_s: plant.horizon_s,
        step_s: 1.0 / (FINE_STEPS * plant.motion_hz),
        start: plant.model.gravity_zero,
        grain: plant.amplitude * 1e-8,
    }
}
