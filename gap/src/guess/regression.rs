//! Start values by least squares: coefficients of given functions in the missing torque.
//!
//! In closed loop such an estimate is biased because the input depends on the noise. It is only the start of a fit.

use super::Evidence;
use nalgebra::{DMatrix, DVector};

/// The motion and the missing torque at one instant, in position units, s and N m.
pub(crate) struct Moment {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub drive_nm: f64,
    pub missing_nm: f64,
    pub session_s: f64,
    /// Time since the first sample of the run, s.
    pub run_s: f64,
}

/// All instants at which the missing torque is known.
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

/// Coefficients of the functions in `basis` that fit the missing torque best, N m per unit of each function. Returns `None` if the data
/// do not determine them.
pub(crate) fn regress<const N: usize>(
    e: &Evidence<'_>,
    basis: impl Fn(&Moment) -> [f64; N],
) -> Option<[f64; N]> {
    regress_in(moments(e), basis).map(|(coefficients, _)| coefficients)
}

/// Coefficients of the functions in `basis` for the given moments, and the sum of squares that they explain, (N m)².
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
