//! Detects a motion that is only periodic.

use super::samples::Samples;
use super::smoother::Smoothed;

/// Number of instants of a stretch that are compared.
const INSTANTS: usize = 500;
/// Largest mean squared difference between a motion and itself one period later, relative to that between two random instants.
const RETURNED: f64 = 0.01;
/// Least relative mean squared difference at a shorter lag. It excludes short lags at which the motion has hardly changed.
const DEPARTED: f64 = 0.3;
/// Share of the rows that must lie in periodic stretches.
const MOST: f64 = 0.8;

/// True if nearly all rows lie in stretches whose position and velocity are periodic. The missing torque may then be a function of any
/// quantity with the same period.
pub(super) fn repeats(samples: &Samples, smoothed: &Smoothed) -> bool {
    let repeating = samples.stretches.iter().filter(|stretch| {
        let every = stretch.rows.len().div_ceil(INSTANTS).max(1);
        let rows = || stretch.rows.clone().step_by(every);
        let x = scaled(rows().map(|row| smoothed.position[row]).collect());
        let v = scaled(rows().map(|row| smoothed.velocity[row]).collect());
        is_periodic(&x, &v)
    });
    let rows: usize = repeating.map(|stretch| stretch.rows.len()).sum();
    rows as f64 > MOST * samples.len() as f64
}

fn is_periodic(x: &[f64], v: &[f64]) -> bool {
    let n = x.len();
    let mut has_departed = false;
    for lag in 1..n / 2 {
        let pairs = 0..n - lag;
        let squares = pairs.map(|i| (x[i + lag] - x[i]).powi(2) + (v[i + lag] - v[i]).powi(2));
        // Two values of variance 1 each differ by 2 in the mean square.
        let difference = squares.sum::<f64>() / (4.0 * (n - lag) as f64);
        has_departed |= difference > DEPARTED;
        if has_departed && difference < RETURNED {
            return true;
        }
    }
    false
}

/// Scales values to mean 0 and variance 1.
fn scaled(values: Vec<f64>) -> Vec<f64> {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let deviation = variance.sqrt().max(f64::MIN_POSITIVE);
    values.into_iter().map(|v| (v - mean) / deviation).collect()
}
