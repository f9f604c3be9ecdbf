//! How much of a difference of two models is left, whatever their numbers are within what is known of them: T-optimality
//! (Atkinson and Fedorov, Biometrika 62, 1975) to first order, with what was recorded before.

use nalgebra::{DMatrix, DVector};

/// Information that every coordinate has, over its own and at least: that of numbers that cannot be told apart.
const VAGUE: f64 = 1e-9;

/// Root mean square, over a noise, of what is left of a `difference` of readings once the coordinates whose `slopes` are the
/// columns have moved so that the squares of what is left, and of the moves by their `information`, are least.
pub(super) fn separation(
    difference: &DVector<f64>,
    slopes: &DMatrix<f64>,
    information: &DMatrix<f64>,
    noise: f64,
) -> f64 {
    let difference = difference / noise;
    let slopes = slopes / noise;
    let mut normal = slopes.tr_mul(&slopes) + information;
    for i in 0..normal.nrows() {
        normal[(i, i)] += VAGUE * (1.0 + normal[(i, i)]);
    }
    let pull = slopes.tr_mul(&difference);
    let moves = normal.cholesky().map(|normal| normal.solve(&pull));
    let made_up = moves.map_or(0.0, |moves| pull.dot(&moves));
    let left = (difference.norm_squared() - made_up).max(0.0);
    (left / difference.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: f64 = 0.1;

    /// Of a difference of one in each of four readings, with a coordinate that moves them alike, known to a deviation of `std`.
    fn left(slope: &[f64], std: f64) -> f64 {
        separation(
            &DVector::from_element(4, 1.0),
            &DMatrix::from_column_slice(4, 1, slope),
            &DMatrix::from_element(1, 1, std.powi(-2)),
            NOISE,
        )
    }

    #[test]
    fn numbers_that_are_known_make_up_for_nothing() {
        assert!((left(&[1.0; 4], 1e-6) - 1.0 / NOISE).abs() < 1e-3);
    }

    #[test]
    fn numbers_that_are_unknown_make_up_for_what_they_can() {
        assert!(left(&[1.0; 4], 1e6) < 1e-3);
        let half = [1.0, 1.0, 0.0, 0.0];
        assert!((left(&half, 1e6) - 0.5f64.sqrt() / NOISE).abs() < 1e-3);
    }

    #[test]
    fn a_coordinate_without_meaning_is_no_matter() {
        assert!((left(&[0.0; 4], f64::INFINITY) - 1.0 / NOISE).abs() < 1e-9);
    }
}
