//! A controller that was not stated: no open loop follows the noise of the position.

use crate::windows::series::largest;
use crate::windows::statistics::quantile;
use nalgebra::{DMatrix, DVector};
use recording::{Run, sixth_differences};

/// Rows before that a controller with a low-pass goes by: of its own output, and of the position, the same row's included.
const OWN: usize = 2;
const OTHER: usize = 4;
/// What is this many times the median is a step of the setpoint, not noise.
const STEP: f64 = 10.0;
/// Singular values of columns of unit length below which they are the same.
const SAME: f64 = 1e-9;
/// What is quick and below this share of the largest input is rounding of the printed digits.
const PRINTED: f64 = 1e-6;
/// Most rows that are looked at: more tell nothing else, and each takes 50 bytes.
const MOST: usize = 200_000;
/// Fewest rows that tell.
const FEWEST: usize = 200;

/// Share of what is quick in the input, beyond what it foretells of itself, that the noise of the position up to then explains
/// (Granger, Econometrica 37, 1969). None if nothing is quick in either.
pub(super) fn share_of_law(run: &Run) -> Option<f64> {
    let quick = |column: &[f64]| sixth_differences(column).collect::<Vec<f64>>();
    let [input, position] = [&run.input, &run.position].map(|column| quick(column));
    let sizes: Vec<f64> = input.iter().map(|u| u.abs()).collect();
    let typical = quantile(&sizes, 0.5);
    if typical <= PRINTED * largest(&run.input) {
        return None;
    }
    let is_noise = |&row: &usize| sizes[row - OWN..=row].iter().all(|u| *u <= STEP * typical);
    // Rows spread evenly, each with those right before it.
    let apart = input.len().div_ceil(MOST).max(1);
    let rows = (OTHER..input.len()).step_by(apart);
    let rows: Vec<usize> = rows.filter(is_noise).collect();
    if rows.len() < FEWEST {
        return None;
    }
    let told = DVector::from_iterator(rows.len(), rows.iter().map(|&row| input[row]));
    let left = |others: usize| {
        let regressor = |i: usize, k: usize| {
            if k < OWN {
                input[rows[i] - 1 - k]
            } else {
                position[rows[i] - (k - OWN)]
            }
        };
        let mut known = DMatrix::from_fn(rows.len(), OWN + others, regressor);
        for mut column in known.column_iter_mut() {
            column.try_normalize_mut(0.0);
        }
        // Without a low-pass a law's own output is what it knew of the position.
        let inverse = known.tr_mul(&known).pseudo_inverse(SAME).ok()?;
        let explained = &known * (inverse * known.tr_mul(&told));
        Some((&told - explained).norm_squared())
    };
    let alone = left(0)?;
    (alone > 0.0).then_some(1.0 - left(OTHER)? / alone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::sensors::Noise;
    use recording::Drive;

    const ROWS: i32 = 3000;

    /// A swing with noise, and the input that is made of it row by row.
    fn run(told: impl Fn(f64, f64, &mut Noise) -> f64) -> Run {
        let mut noise = Noise::new(7);
        let time: Vec<f64> = (0..ROWS).map(|k| 1e-3 * f64::from(k)).collect();
        let (mut input, mut position) = (Vec::new(), Vec::new());
        for t in &time {
            let x = 0.3 * (9.0 * t).sin() + noise.next(1e-4);
            position.push(x);
            input.push(told(*t, x, &mut noise));
        }
        Run::new("run.csv", Drive::OpenLoop, time, input, position)
    }

    #[test]
    fn a_law_of_the_position_is_told_from_a_course_that_goes_with_it() {
        let law = run(|t, x, _| 0.2 * ((3.0 * t).sin() - x));
        assert!(share_of_law(&law).unwrap() > 0.99);
        let course = run(|t, _, noise| 0.06 * (9.0 * t).sin() + noise.next(1e-5));
        assert!(share_of_law(&course).unwrap() < 0.05);
        let steps = run(|t, _, _| (3.0 * t).floor());
        assert_eq!(share_of_law(&steps), None);
    }
}
