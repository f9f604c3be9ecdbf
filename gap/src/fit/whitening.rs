//! Whitens the residuals of a window for the uncertainty of its restart.

use crate::predict::Predictor;
use crate::windows::series::{Series, Window};
use nalgebra::{Matrix2, SymmetricEigen};

/// Factor on the standard deviations of the restart from white noise. A cubic cannot follow a fast motion within its samples, which adds
/// an error.
const RESTART_INFLATION: f64 = 1.5;

/// Turns the residual r of one window into one of unit covariance: `(I + G Gᵀ/σ²)^−½ r/σ`, with the sensitivity G to the restart and the
/// noise σ of sensor and model error. The squared norm is the cost with the restart state marginalized.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    /// G/σ, one row per sample, rotated to the axes on which `GᵀG` is diagonal.
    sensitivity: Vec<[f64; 2]>,
    /// `((1 + m)^−½ − 1)/m` for the two eigenvalues m of `GᵀG/σ²`.
    factors: [f64; 2],
    noise: f64,
}

impl Whitening {
    fn new(window: &Window, modelling: f64, sensitivity: &[[f64; 2]]) -> Self {
        let noise = window.noise.hypot(modelling);
        let fit = &window.restart;
        let sd = [0, 1].map(|i| fit.covariance[i][i].sqrt());
        let correlation = (fit.covariance[0][1] / (sd[0] * sd[1])).clamp(-1.0, 1.0);
        let rest = (1.0 - correlation * correlation).sqrt();
        let scale = RESTART_INFLATION / noise;
        let mut rows: Vec<[f64; 2]> = sensitivity
            .iter()
            .map(|[a, b]| [scale * (a + correlation * b), scale * rest * b])
            .collect();
        let mut m = Matrix2::zeros();
        for [a, b] in &rows {
            m += Matrix2::new(a * a, a * b, a * b, b * b);
        }
        let eigen = SymmetricEigen::new(m);
        let v = eigen.eigenvectors;
        for row in &mut rows {
            let [a, b] = *row;
            *row = [a * v[(0, 0)] + b * v[(1, 0)], a * v[(0, 1)] + b * v[(1, 1)]];
        }
        let factors = [0, 1].map(|i| {
            let m = eigen.eigenvalues[i].max(0.0);
            // The limit of the formula for a window that does not depend on its restart.
            if m < 1e-9 {
                -0.5
            } else {
                ((1.0 + m).sqrt().recip() - 1.0) / m
            }
        });
        Self {
            sensitivity: rows,
            factors,
            noise,
        }
    }

    /// Whitens `residual` in place.
    pub(crate) fn apply(&self, residual: &mut [f64]) {
        let mut projected = [0.0; 2];
        for (r, [a, b]) in residual.iter().zip(&self.sensitivity) {
            projected[0] += a * r;
            projected[1] += b * r;
        }
        let [p, q] = [
            projected[0] * self.factors[0],
            projected[1] * self.factors[1],
        ];
        for (r, [a, b]) in residual.iter_mut().zip(&self.sensitivity) {
            *r = (*r + a * p + b * q) / self.noise;
        }
    }
}

/// The whitenings of all wanted windows of a series, for the sensitivity of a predictor to the restarts and an allowed model error
/// `modelling`. The entries of the other windows are `None`.
pub(crate) fn whitenings(
    predictor: &Predictor,
    series: &Series,
    predicted: &[f64],
    modelling: f64,
    wanted: impl Fn(usize) -> bool + Copy + Sync,
) -> Vec<Option<Whitening>> {
    let sensitivity = restart_sensitivity(predictor, series, predicted, wanted);
    let windows = series.windows.iter().enumerate();
    windows
        .map(|(index, window)| {
            wanted(index)
                .then(|| Whitening::new(window, modelling, &sensitivity[window.samples.clone()]))
        })
        .collect()
}

/// Step of the finite difference for the sensitivity to a restart, in standard deviations of the restart. It is as large as the errors
/// themselves because stick and slip make the prediction nonlinear.
const SENSITIVITY_SHIFT: f64 = 0.7;

/// Change of each predicted position per standard deviation of the position and of the velocity of its restart.
fn restart_sensitivity(
    predictor: &Predictor,
    series: &Series,
    predicted: &[f64],
    wanted: impl Fn(usize) -> bool + Sync,
) -> Vec<[f64; 2]> {
    let shifted = |shift| predictor.predict_shifted(series, shift, &wanted);
    let (value, slope) = rayon::join(
        || shifted([SENSITIVITY_SHIFT, 0.0]),
        || shifted([0.0, SENSITIVITY_SHIFT]),
    );
    let shifted = value.iter().zip(&slope).zip(predicted);
    shifted
        .map(|((v, s), p)| [(v - p) / SENSITIVITY_SHIFT, (s - p) / SENSITIVITY_SHIFT])
        .collect()
}

/// Number of partial sums of an inner product. A single sum would wait for each addition.
const LANES: usize = 8;

/// Inner product of two residuals.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, last_a), (b, last_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f64 = last_a.iter().zip(last_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}
