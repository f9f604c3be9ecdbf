//! Draws what the manifest states: input limit, lag, delay, travel and tolerances.

use std::f64::consts::TAU;

use recording::Tolerance;

use super::secret::Secret;
use crate::draw::Draw;
use crate::scenario::{Hidden, OVERSTATED_LIMITS, Plant, Scale};

/// Overstated lags and delays over the time constant of the motion.
const OVERSTATED_TIMES: [f64; 2] = [0.05, 0.4];
/// Distance of an overstated stop from the middle, over the half span of the motion.
const OVERSTATED_STOPS: [f64; 2] = [0.5, 0.9];
/// Penetration of a stated stop under the torque of the motion, over the half span.
const PRESSED: f64 = 0.02;

/// Model numbers with the least and the largest relative tolerance that is usual for each.
pub(super) const USUAL_TOLERANCES: [(&str, f64, f64); 6] = [
    ("inertia", 0.005, 0.03),
    ("viscous", 0.05, 0.3),
    ("coulomb", 0.02, 0.15),
    ("gravity", 0.01, 0.05),
    ("stiffness", 0.01, 0.05),
    ("ratio", 0.003, 0.02),
];

/// States a lag or delay that the device does not have or that is too long, if that is the hidden effect.
pub(super) fn overstate(draw: &mut Draw, plant: &mut Plant, secrets: &[Secret]) {
    for name in overstated(secrets) {
        let [low, high] = OVERSTATED_TIMES;
        let time_s = draw.log_uniform(low, high) / (TAU * plant.motion_hz);
        match name {
            "lag" => plant.model.lag = time_s,
            "delay" => plant.model.delay = time_s,
            _ => {}
        }
    }
}

fn overstated(secrets: &[Secret]) -> impl Iterator<Item = &'static str> {
    let overstated = known(secrets).filter(|hidden| hidden.is_overstated());
    overstated.map(|hidden| hidden.name)
}

/// The hidden effects that belong to the vocabulary.
fn known(secrets: &[Secret]) -> impl Iterator<Item = &Hidden> {
    secrets.iter().filter_map(|secret| match secret {
        Secret::Known(hidden) => Some(hidden),
        Secret::Foreign(_) | Secret::Own(_) => None,
    })
}

/// States stops inside the true travel, if that is the hidden effect.
pub(super) fn narrow_travel(draw: &mut Draw, plant: &mut Plant, scale: &Scale, secrets: &[Secret]) {
    if overstated(secrets).any(|name| name == "end_stop") {
        let [low, high] = OVERSTATED_STOPS;
        let at = [-1.0, 1.0].map(|side| side * draw.uniform(low, high) * scale.half_span);
        plant.model.travel = Some(at.map(|at| scale.middle + at));
        plant.model.stop_stiffness = scale.torque / (PRESSED * scale.half_span);
    }
}

/// States an input limit on some devices. It is too low if that is the hidden effect. Otherwise most motions do not reach
/// it.
pub(super) fn limit_input(draw: &mut Draw, plant: &mut Plant, scale: &Scale, secrets: &[Secret]) {
    let is_low = overstated(secrets).any(|name| name == "saturation");
    if is_low || draw.chance(0.5) {
        let factor = if is_low {
            draw.log_uniform(OVERSTATED_LIMITS[0], OVERSTATED_LIMITS[1])
        } else if known(secrets).any(|hidden| hidden.name == "saturation") {
            draw.uniform(1.2, 2.5)
        } else {
            draw.log_uniform(0.8, 2.5)
        };
        let limit = scale.input * factor;
        let digits = 10f64.powi(3 - limit.log10().floor() as i32);
        plant.model.input_limit = Some((limit * digits).round() / digits);
    }
}

/// Draws the stated tolerances of the nominal numbers.
pub(super) fn tolerance(draw: &mut Draw, plant: &Plant, secrets: &[Secret]) -> Tolerance {
    let mut tolerance = Tolerance::default();
    if !draw.chance(0.6) {
        return tolerance;
    }
    for (name, low, high) in USUAL_TOLERANCES {
        let relative = draw.log_uniform(low, high);
        let touched = known(secrets).any(|hidden| hidden.touches().contains(&name));
        // A number that a hidden effect changes gets a small tolerance, so that the change lies far outside it.
        let relative = if touched { low } else { relative };
        if plant.model.get(name).is_some_and(|value| value != 0.0) && draw.chance(0.8) {
            tolerance.set(name, (relative * 1e4).round() / 1e4);
        }
    }
    tolerance
}
