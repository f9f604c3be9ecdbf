//! Torques of deviations of the model parameters within their tolerances.

use super::path::Path;
use host_sim::device::Device;
use recording::Recording;

/// Torque over each step for one standard deviation of each parameter with a tolerance.
pub(super) fn tolerance_torques(recording: &Recording, path: &Path<'_>) -> Vec<Vec<f64>> {
    let nominal = Device::nominal(&recording.model);
    let without = path.torque(&nominal);
    let stated = recording.tolerance.iter();
    let columns = stated.filter_map(|(name, relative)| {
        let mut model = recording.model;
        let value = model.get(name)?;
        if relative <= 0.0 || !model.set(name, (1.0 + relative) * value) {
            return None;
        }
        let moved = Device::nominal(&model);
        // From J' a = T' follows J a − T = T' − T − (J'/J − 1) T to first order.
        let added_inertia = moved.mechanics.inertia / nominal.mechanics.inertia - 1.0;
        let pairs = path.torque(&moved).into_iter().zip(&without);
        let column = pairs.map(|(with, without)| with - without - added_inertia * without);
        let column: Vec<f64> = column.collect();
        column.iter().any(|t| *t != 0.0).then_some(column)
    });
    columns.collect()
}
