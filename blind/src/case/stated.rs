//! What is stated about a device: a limit of its input, and the tolerances of its numbers.

use recording::Tolerance;

use super::secret::Secret;
use crate::draw::Draw;
use crate::scenario::{Plant, Scale};

/// States a limit of the input on some devices, mostly one that is never met.
pub(super) fn limit_input(draw: &mut Draw, plant: &mut Plant, scale: &Scale, generous: bool) {
    if draw.chance(0.5) {
        let factor = if generous {
            draw.uniform(1.2, 2.5)
        } else {
            draw.log_uniform(0.8, 2.5)
        };
        let limit = scale.input * factor;
        let digits = 10f64.powi(3 - limit.log10().floor() as i32);
        plant.model.input_limit = Some((limit * digits).round() / digits);
    }
}

/// What is stated about the nominal numbers.
pub(super) fn tolerance(draw: &mut Draw, plant: &Plant, secrets: &[Secret]) -> Tolerance {
    let mut tolerance = Tolerance::default();
    if !draw.chance(0.6) {
        return tolerance;
    }
    let usual = [
        ("inertia", 0.005, 0.03),
        ("viscous", 0.05, 0.3),
        ("coulomb", 0.02, 0.15),
        ("gravity", 0.01, 0.05),
        ("stiffness", 0.01, 0.05),
        ("ratio", 0.003, 0.02),
    ];
    for (name, low, high) in usual {
        let relative = draw.log_uniform(low, high);
        let touched = secrets.iter().any(|secret| match secret {
            Secret::Known(hidden) => hidden.touches().contains(&name),
            Secret::Foreign(_) => false,
        });
        // What is hidden in a number must lie far outside what is stated about it.
        let relative = if touched { low } else { relative };
        if plant.model.get(name).is_some_and(|value| value != 0.0) && draw.chance(0.8) {
            tolerance.set(name, (relative * 1e4).round() / 1e4);
        }
    }
    tolerance
}
