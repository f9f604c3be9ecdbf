//! The separation of two models that no choice of their uncertain parameters can compensate: T-optimality (Atkinson and Fedorov,
//! Biometrika 62, 1975) to first order, with the information of the recorded data.

use nalgebra::{DMatrix, DVector};

/// Least information of every coordinate, and as a share of its own. It keeps coordinates finite that cannot be distinguished.
const LEAST_INFORMATION: f64 = 1e-9;

/// Rms of the remaining `difference` of readings, over the noise. The coordinates, whose `slopes` are the columns, move so that the sum
/// of the squared remaining difference and of the squared moves, weighted by their `information`, is least.
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
        normal[(i, i)] += LEAST_INFORMATION * (1.0 + normal[(i, i)]);
    }
    let gradient = slopes.tr_mul(&difference);
    let moves = normal.cholesky().map(|normal| normal.solve(&gradient));
    let compensated = moves.map_or(0.0, |moves| gradient.dot(&moves));
    let remaining = (difference.norm_squared() - compensated).max(0.0);
    (remaining / difference.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: f64 = 0.1;

    /// The separation for a difference of one in each of four readings, with one coordinate of standard deviation `std`.
    fn separation_with(slope: &[f64], std: f64) -> f64 {
        separation(
            &DVector::from_element(4, 1.0),
            &DMatrix::from_column_slice(4, 1, slope),
            &DMatrix::from_element(1, 1, std.powi(-2)),
            NOISE,
        )
    }

    #[test]
    fn a_known_parameter_compensates_nothing() {
        assert!((separation_with(&[1.0; 4], 1e-6) - 1.0 / NOISE).abs() < 1e-3);
    }

    #[test]
    fn an_unknown_parameter_compensates_what_it_can() {
        assert!(separation_with(&[1.0; 4], 1e6) < 1e-3);
        let half = [1.0, 1.0, 0.0, 0.0];
        assert!((separation_with(&half, 1e6) - 0.5f64.sqrt() / NOISE).abs() < 1e-3);
    }

    #[test]
    fn a_coordinate_without_influence_does_not_matter() {
        assert!((separation_with(&[0.0; 4], f64::INFINITY) - 1.0 / NOISE).abs() < 1e-9);
    }
}
