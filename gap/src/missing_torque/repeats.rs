//! Whether a motion only repeats itself.

use super::samples::Samples;
use super::smoother::Smoothed;

/// Instants of a stretch that are compared.
const INSTANTS: usize = 500;
/// Mean square by which a motion differs from itself a period later, over that of two instants at random.
const SAME: f64 = 0.01;
/// And at the least somewhere in between: before, it has not gone away yet.
const AWAY: f64 = 0.3;
/// Share of the rows in stretches that repeat.
const MOST: f64 = 0.8;

/// True if nearly all of the time is in stretches whose position and velocity come again after some time: what is missing
/// there may go with anything that comes again with them.
pub(super) fn repeats(samples: &Samples, smoothed: &Smoothed) -> bool {
    let repeating = samples.stretches.iter().filter(|stretch| {
        let every = stretch.rows.len().div_ceil(INSTANTS).max(1);
        let rows = || stretch.rows.clone().step_by(every);
        let x = scaled(rows().map(|row| smoothed.position[row]).collect());
        let v = scaled(rows().map(|row| smoothed.velocity[row]).collect());
        comes_again(&x, &v)
    });
    let rows: usize = repeating.map(|stretch| stretch.rows.len()).sum();
    rows as f64 > MOST * samples.len() as f64
}

fn comes_again(x: &[f64], v: &[f64]) -> bool {
    let n = x.len();
    let mut was_away = false;
    for lag in 1..n / 2 {
        let pairs = 0..n - lag;
        let squares = pairs.map(|i| (x[i + lag] - x[i]).powi(2) + (v[i + lag] - v[i]).powi(2));
        // Two values of variance 1 each differ by 2 in the mean square.
        let apart = squares.sum::<f64>() / (4.0 * (n - lag) as f64);
        was_away |= apart > AWAY;
        if was_away && apart < SAME {
            return true;
        }
    }
    false
}

/// To mean 0 and variance 1.
fn scaled(values: Vec<f64>) -> Vec<f64> {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let deviation = variance.sqrt().max(f64::MIN_POSITIVE);
    values.into_iter().map(|v| (v - mean) / deviation).collect()
}
