//! Estimates an initial inertia from a recording, if the user does not know it.

use nalgebra::{DMatrix, DVector};
use recording::{Recording, Run};

/// Largest number of windows that are evaluated in a run.
const WINDOWS: f64 = 2000.0;
/// Distance between windows, as a share of their length.
const STEP: f64 = 0.2;
/// Number of torque components: inertia, viscous and dry friction, gravity, a constant.
const COLUMNS: usize = 5;

/// An inertia and its relative standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Inertia {
    pub value: f64,
    pub deviation: f64,
}

/// Estimates the inertia for which the torques of the recording cause its motion. `ratio` is the joint torque per unit of
/// input, and `stiffness` that of a spring to 0. Frictions, a constant torque and, for an axis that may have it, gravity are
/// estimated too. `None` if there is no input or no motion.
///
/// It uses modulating functions (M. Shinbrot, Trans. ASME 79, 1957). The equation of motion is weighted with a window
/// function that is zero at its ends, as are its derivatives. Integration by parts then avoids differentiating the position.
pub(crate) fn inertia(recording: &Recording, ratio: f64, stiffness: f64) -> Option<Inertia> {
    let window_s = 2.0 * recording.horizon;
    let angle = recording.units.angle_rad();
    let mut rows: Vec<([f64; COLUMNS], f64)> = Vec::new();
    for run in &recording.runs {
        let step_s = (window_s * STEP).max(run.duration_s() / WINDOWS);
        let mut from_s = run.time[0];
        while from_s + window_s <= *run.time.last()? {
            rows.extend(weighted(run, from_s, window_s, ratio, stiffness, angle));
            from_s += step_s;
        }
    }
    regressed(&rows).or_else(|| crude(&rows))
}

/// Estimate by least squares.
fn regressed(rows: &[([f64; COLUMNS], f64)]) -> Option<Inertia> {
    if rows.len() < 3 * COLUMNS {
        return None;
    }
    let mut regressors = DMatrix::from_fn(rows.len(), COLUMNS, |row, column| rows[row].0[column]);
    let torques = DVector::from_fn(rows.len(), |row, _| rows[row].1);
    // Columns are scaled to similar magnitudes, so that small ones are not lost.
    let sizes: Vec<f64> = (0..COLUMNS)
        .map(|column| regressors.column(column).norm())
        .collect();
    for (column, size) in sizes.iter().enumerate() {
        if *size > 0.0 {
            regressors.column_mut(column).scale_mut(1.0 / size);
        }
    }
    let solved = regressors
        .clone()
        .svd(true, true)
        .solve(&torques, 1e-9)
        .ok()?;
    let left = (&torques - &regressors * &solved).norm_squared();
    // Windows overlap, so only a part of them is independent.
    let own = STEP * rows.len() as f64;
    let inverse = (regressors.transpose() * &regressors).try_inverse()?;
    let deviation = (left / own.max(1.0) * inverse[(0, 0)] / STEP).sqrt() / solved[0].abs();
    let value = solved[0] / sizes[0];
    let is_known = value > 0.0 && value.is_finite() && deviation < 1.0;
    is_known.then_some(Inertia { value, deviation })
}

/// Estimate from magnitudes only: torque over acceleration.
fn crude(rows: &[([f64; COLUMNS], f64)]) -> Option<Inertia> {
    let torques: f64 = rows.iter().map(|(_, torque)| torque * torque).sum();
    let accelerations: f64 = rows.iter().map(|(shares, _)| shares[0] * shares[0]).sum();
    let value = (torques / accelerations).sqrt();
    (value.is_finite() && value > 0.0).then_some(Inertia {
        value,
        deviation: 1.0,
    })
}

/// The contributions of one window to inertia, viscous and dry friction, gravity and the constant, and to the torque.
fn weighted(
    run: &Run,
    from_s: f64,
    window_s: f64,
    ratio: f64,
    stiffness: f64,
    angle: f64,
) -> Option<([f64; COLUMNS], f64)> {
    let first = run.time.partition_point(|t| *t < from_s);
    let last = run.time.partition_point(|t| *t < from_s + window_s);
    if last - first < 8 || last >= run.len() {
        return None;
    }
    let mut shares = [0.0; COLUMNS];
    let mut torque = 0.0;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for row in first..last {
        let dt_s = (run.time[row + 1] - run.time[row.saturating_sub(1)]) / 2.0;
        let s = (run.time[row] - from_s) / window_s;
        let r = s * (1.0 - s);
        // (s - s²)³ and its derivatives with respect to time.
        let weight = r.powi(3);
        let slope = 3.0 * r * r * (1.0 - 2.0 * s) / window_s;
        let bend = (6.0 * r * (1.0 - 2.0 * s).powi(2) - 6.0 * r * r) / window_s.powi(2);
        let x = run.position[row];
        let velocity =
            run.position[(row + 2).min(run.len() - 1)] - run.position[row.saturating_sub(2)];
        shares[0] += bend * x * dt_s;
        shares[1] -= slope * x * dt_s;
        shares[2] += weight * velocity.signum() * f64::from(u8::from(velocity != 0.0)) * dt_s;
        shares[3] += weight * (angle * x).sin() * dt_s;
        shares[4] += weight * dt_s;
        torque += weight * (ratio * run.input[row] - stiffness * x) * dt_s;
        (low, high) = (low.min(x), high.max(x));
    }
    (high > low).then_some((shares, torque))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::{Drive, Model};

    #[test]
    fn the_inertia_is_found_in_the_presence_of_friction() {
        let (inertia_true, viscous, coulomb) = (5.8e-4, 2e-3, 2e-3);
        let dt_s = 1e-3;
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for k in 0..8000 {
            let t = f64::from(k) * dt_s;
            let u = 0.02 * (9.0 * t).sin() + 0.015 * (23.0 * t).sin();
            columns[0].push(t);
            columns[1].push(u);
            // Quantised like a counter.
            columns[2].push((x / 2e-4).round() * 2e-4);
            for _ in 0..10 {
                v += (u - viscous * v - coulomb * v.signum() - 0.0146 * x.sin()) / inertia_true
                    * dt_s
                    / 10.0;
                x += v * dt_s / 10.0;
            }
        }
        let [time, input, position] = columns;
        let mut recording = Recording::new("", 0.1, Model::new(1.0));
        recording
            .runs
            .push(Run::new("a.csv", Drive::OpenLoop, time, input, position));
        let found = inertia(&recording, 1.0, 0.0).expect("an inertia");
        assert!((found.value / inertia_true - 1.0).abs() < 0.1, "{found:?}");
    }
}
