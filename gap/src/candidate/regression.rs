//! First guesses by least squares: what the missing torque is made of.
//!
//! In closed loop such a guess is biased, as the input follows the noise; it only starts a fit.

use super::Evidence;
use nalgebra::{DMatrix, DVector};

/// One moment of motion whose direction is known.
pub(super) struct Moment {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub drive_nm: f64,
    pub session_s: f64,
}

/// Coefficients of `basis` in the missing torque; `None` where they are not determined.
pub(super) fn regress<const N: usize>(
    e: &Evidence<'_>,
    basis: impl Fn(&Moment) -> [f64; N],
) -> Option<[f64; N]> {
    let mut normal = DMatrix::<f64>::zeros(N, N);
    let mut right = DVector::<f64>::zeros(N);
    for (series, motion) in e.series.iter().zip(e.motions) {
        for (i, missing) in motion.missing_nm.iter().enumerate() {
            if !missing.is_finite() {
                continue;
            }
            let row = basis(&Moment {
                position: motion.position[i],
                velocity: motion.velocity[i],
                acceleration: motion.acceleration[i],
                drive_nm: motion.drive_nm[i],
                session_s: series.session(i),
            });
            for a in 0..N {
                right[a] += row[a] * missing;
                for b in 0..N {
                    normal[(a, b)] += row[a] * row[b];
                }
            }
        }
    }
    let solution = normal.cholesky()?.solve(&right);
    let coefficients: [f64; N] = core::array::from_fn(|i| solution[i]);
    coefficients
        .iter()
        .all(|c| c.is_finite())
        .then_some(coefficients)
}
