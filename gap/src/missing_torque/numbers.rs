//! The model's own numbers, which are known to within a tolerance only.

use super::path::Path;
use recording::Recording;

/// Torque over each step for one standard deviation of each number that has a tolerance.
pub(super) fn numbers(recording: &Recording, path: &Path<'_>) -> Vec<Vec<f64>> {
    let stated = recording
        .tolerance
        .iter()
        .filter(|(_, relative)| *relative > 0.0);
    let columns = stated.filter_map(|(name, relative)| {
        let mut device = path.device.clone();
        let m = &mut device.mechanics;
        let factor = 1.0 + relative;
        match name {
            // J' a = T, so that J a − T = (J/J' − 1) T.
            "inertia" => {
                let torque = path.torque(path.device);
                return Some(torque.into_iter().map(|t| -relative * t).collect());
            }
            "viscous" => m.viscous *= factor,
            "coulomb" => m.friction.scale(factor),
            "gravity" => m.gravity *= factor,
            "gravity_zero" => m.gravity_zero *= factor,
            "stiffness" => m.stiffness *= factor,
            "stiffness_zero" => m.stiffness_zero *= factor,
            "offset" => m.offset_nm *= factor,
            "ratio" => device.drive.ratio *= factor,
            "delay" => device.drive.delay_s *= factor,
            "lag" => device.drive.lag_s *= factor,
            "input_limit" => device.drive.limit *= factor,
            _ => return None,
        }
        let column = path.on_top(&device);
        column.iter().any(|t| *t != 0.0).then_some(column)
    });
    columns.collect()
}
