//! What logs a device.

use recording::{Sensor, low_pass_gain};

use super::FINE_STEPS;
use crate::draw::Draw;
use crate::scenario::Plant;
use crate::session::Logging;

/// `decides`: a second sensor would say something; `two_sided`: motor and load are not at one place.
pub(super) fn logging(draw: &mut Draw, plant: &Plant, decides: bool, two_sided: bool) -> Logging {
    let coarser = draw.log_uniform(1.0, 4.0);
    let second = Sensor {
        resolution: 0.0,
        noise: coarser * plant.sensor.noise.max(plant.sensor.resolution / 3.0),
        cutoff_hz: None,
    };
    let there = draw.chance(if decides { 0.4 } else { 0.15 }) && !two_sided;
    Logging {
        sensor: plant.sensor,
        logged_gain: low_pass_gain(plant.sensor.cutoff_hz, plant.tick_s),
        filters_noise: draw.chance(0.7),
        second: there.then_some(second),
        horizon_s: plant.horizon_s,
        step_s: 1.0 / (FINE_STEPS * plant.motion_hz),
        start: plant.model.gravity_zero,
        grain: plant.amplitude * 1e-8,
    }
}
