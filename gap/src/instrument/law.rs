//! Detects a controller that is not stated. In open loop the input does not follow the noise of the position.

use crate::windows::series::largest;
use crate::windows::statistics::quantile;
use nalgebra::{DMatrix, DVector};
use recording::{Run, sixth_differences};

/// Number of previous rows of the input, and number of rows of the position including the present one, that predict the output of a
/// controller with a low-pass.
const INPUT_ROWS: usize = 2;
const POSITION_ROWS: usize = 4;
/// Multiple of the median beyond which a change of the input is a step of the setpoint and not noise.
const STEP_RATIO: f64 = 10.0;
/// Least singular value of normalized columns that are not linearly dependent.
const DEPENDENT: f64 = 1e-9;
/// Share of the largest input below which fast changes are rounding of the printed digits.
const ROUNDING: f64 = 1e-6;
/// Largest number of rows that are used. More rows give no more information, and each takes 50 bytes.
const MOST_ROWS: usize = 200_000;
/// Least number of rows for a decision.
const FEWEST_ROWS: usize = 200;

/// Share of the fast changes of the input that the noise of the position up to that instant explains, beyond the prediction of the input
/// from its own past (Granger, Econometrica 37, 1969). Returns `None` if the input has no fast changes, or too few rows.
pub(super) fn share_of_law(run: &Run) -> Option<f64> {
    let fast_changes = |column: &[f64]| sixth_differences(column).collect::<Vec<f64>>();
    let [input, position] = [&run.input, &run.position].map(|column| fast_changes(column));
    let sizes: Vec<f64> = input.iter().map(|u| u.abs()).collect();
    let typical = quantile(&sizes, 0.5);
    if typical <= ROUNDING * largest(&run.input) {
        return None;
    }
    let is_noise = |&row: &usize| {
        sizes[row - INPUT_ROWS..=row]
            .iter()
            .all(|u| *u <= STEP_RATIO * typical)
    };
    // Evenly spread rows.
    let spacing = input.len().div_ceil(MOST_ROWS).max(1);
    let rows = (POSITION_ROWS..input.len()).step_by(spacing);
    let rows: Vec<usize> = rows.filter(is_noise).collect();
    if rows.len() < FEWEST_ROWS {
        return None;
    }
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|&row| input[row]));
    let residual = |others: usize| {
        let regressor = |i: usize, k: usize| {
            if k < INPUT_ROWS {
                input[rows[i] - 1 - k]
            } else {
                position[rows[i] - (k - INPUT_ROWS)]
            }
        };
        let mut regressors = DMatrix::from_fn(rows.len(), INPUT_ROWS + others, regressor);
        for mut column in regressors.column_iter_mut() {
            column.try_normalize_mut(0.0);
        }
        // Without a low-pass, past outputs of the controller depend linearly on past positions, so the matrix may be singular.
        let inverse = regressors
            .tr_mul(&regressors)
            .pseudo_inverse(DEPENDENT)
            .ok()?;
        let explained = &regressors * (inverse * regressors.tr_mul(&target));
        Some((&target - explained).norm_squared())
    };
    let alone = residual(0)?;
    (alone > 0.0).then_some(1.0 - residual(POSITION_ROWS)? / alone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::sensors::Noise;
    use recording::Drive;

    const ROWS: i32 = 3000;

    /// A run with a noisy sinusoidal position, and the input that `input_of` computes row by row.
    fn run(input_of: impl Fn(f64, f64, &mut Noise) -> f64) -> Run {
        let mut noise = Noise::new(7);
        let time: Vec<f64> = (0..ROWS).map(|k| 1e-3 * f64::from(k)).collect();
        let (mut input, mut position) = (Vec::new(), Vec::new());
        for t in &time {
            let x = 0.3 * (9.0 * t).sin() + noise.next(1e-4);
            position.push(x);
            input.push(input_of(*t, x, &mut noise));
        }
        Run::new("run.csv", Drive::OpenLoop, time, input, position)
    }

    #[test]
    fn a_controller_is_distinguished_from_an_input_that_correlates_with_the_motion() {
        let law = run(|t, x, _| 0.2 * ((3.0 * t).sin() - x));
        assert!(share_of_law(&law).unwrap() > 0.99);
        let feedforward = run(|t, _, noise| 0.06 * (9.0 * t).sin() + noise.next(1e-5));
        assert!(share_of_law(&feedforward).unwrap() < 0.05);
        let steps = run(|t, _, _| (3.0 * t).floor());
        assert_eq!(share_of_law(&steps), None);
    }
}
