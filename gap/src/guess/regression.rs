//! First guesses by least squares: what the missing torque is made of.
//!
//! In closed loop such a guess is biased, as the input follows the noise; it only starts a fit.

use super::Evidence;
use nalgebra::{DMatrix, DVector};

/// One moment of motion whose direction is known.
pub(crate) struct Moment {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub drive_nm: f64,
    pub missing_nm: f64,
    pub session_s: f64,
    /// Since the first sample of its run.
    pub run_s: f64,
}

/// Every moment at which the missing torque is known.
pub(crate) fn moments(e: &Evidence<'_>) -> impl Iterator<Item = Moment> {
    let pairs = e.series.iter().zip(e.motions);
    pairs.flat_map(|(series, motion)| {
        let missing = motion.missing_nm.iter().enumerate();
        missing
            .filter(|(_, missing)| missing.is_finite())
            .map(|(i, missing)| Moment {
                position: motion.position[i],
                velocity: motion.velocity[i],
                acceleration: motion.acceleration[i],
                drive_nm: motion.drive_nm[i],
                missing_nm: *missing,
                session_s: series.session(i),
                run_s: series.time[i] - series.started_s,
            })
    })
}

/// Coefficients of `basis` in the missing torque; `None` where they are not determined.
pub(crate) fn regress<const N: usize>(
    e: &Evidence<'_>,
    basis: impl Fn(&Moment) -> [f64; N],
) -> Option<[f64; N]> {
    regress_in(moments(e), basis).map(|(coefficients, _)| coefficients)
}

/// The same in some of the moments, and the sum of squares that they explain, (N m)².
pub(crate) fn regress_in<const N: usize>(
    moments: impl Iterator<Item = Moment>,
    basis: impl Fn(&Moment) -> [f64; N],
) -> Option<([f64; N], f64)> {
    let mut normal = DMatrix::<f64>::zeros(N, N);
    let mut right = DVector::<f64>::zeros(N);
    for moment in moments {
        let row = basis(&moment);
        for a in 0..N {
            right[a] += row[a] * moment.missing_nm;
            for b in 0..N {
                normal[(a, b)] += row[a] * row[b];
            }
        }
    }
    let solution = normal.cholesky()?.solve(&right);
    let coefficients: [f64; N] = core::array::from_fn(|i| solution[i]);
    let explained = solution.dot(&right);
    let is_finite = coefficients.iter().all(|c| c.is_finite());
    is_finite.then_some((coefficients, explained))
}
