//! Chooses the amplitude of each open-loop run.

use crate::reality::Reality;
use crate::scenario::{Drive, Plan, Plant, Scale};
use crate::session::{self, Logging};

/// Simulation steps per period of the motion. The amplitude search needs no more accuracy than this.
const COARSE_STEPS: f64 = 4_000.0;

/// Sets the input amplitude of each open-loop run so that the device reaches the wanted half span. Returns the scale of the
/// resulting motion. Returns `None` if no amplitude reaches it.
pub(super) fn set_amplitudes(
    plans: &mut [Plan],
    plant: &Plant,
    logging: &Logging,
) -> Option<Scale> {
    let plain = Reality::plain(&plant.model);
    let coarse = Logging {
        step_s: 1.0 / (COARSE_STEPS * plant.motion_hz),
        second: None,
        ..logging.clone()
    };
    let half_span = |plan: &Plan| {
        let log = session::carry_out(&plain, std::slice::from_ref(plan), &coarse).remove(0);
        let (low, high) = session::extremes(&log.position);
        0.5 * (high - low)
    };
    for plan in plans.iter_mut() {
        let Drive::Open {
            amplitude: wanted, ..
        } = plan.drive
        else {
            continue;
        };
        let model = &plant.model;
        let most =
            (model.coulomb + model.gravity + model.stiffness * wanted + 4.0 * plant.torque())
                / model.ratio;
        let (mut low, mut high) = (0.02 * most, 2.0 * most);
        for _ in 0..8 {
            let middle = f64::sqrt(low * high);
            if let Drive::Open { amplitude, .. } = &mut plan.drive {
                *amplitude = middle;
            }
            if half_span(plan) > wanted {
                high = middle
            } else {
                low = middle
            }
        }
        let reached = half_span(plan);
        if !(0.4 * wanted..2.5 * wanted).contains(&reached) {
            return None;
        }
    }
    let logs = session::carry_out(&plain, plans, &coarse);
    let scale = session::scale(&logs, plant.model.ratio, plant.motion_hz, &plant.sensor);
    (scale.half_span.is_finite() && scale.half_span > 0.3 * plant.amplitude && scale.speed > 0.0)
        .then_some(scale)
}
