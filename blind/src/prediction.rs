//! The windowed prediction of the contract, with any [`Reality`] as the model.

use crate::reality::{InputSeries, Reality, State};
use crate::session::Log;

/// How the hidden states are set at the start of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HiddenStates {
    /// They continue from the end of the previous window.
    Carried,
    /// They take their true values.
    Known,
}

/// Half width of the fit at a restart, and its fewest samples, as the contract defines them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Restart {
    pub horizon_s: f64,
    pub half_width_s: f64,
    /// Gain of the low-pass of the logged column.
    pub logged_gain: f64,
    pub logged_lag_s: f64,
}

const FEWEST_SAMPLES: usize = 9;

/// Predicts the position of every row of every run.
pub(crate) fn predict(
    model: &Reality,
    logs: &[Log],
    restart: Restart,
    hidden: HiddenStates,
    step_s: f64,
) -> Vec<Vec<f64>> {
    logs.iter()
        .enumerate()
        .map(|(run, log)| predict_run(model, run, log, restart, hidden, step_s))
        .collect()
}

fn predict_run(
    model: &Reality,
    run: usize,
    log: &Log,
    restart: Restart,
    hidden: HiddenStates,
    step_s: f64,
) -> Vec<f64> {
    let series = InputSeries::new(log.time_s.clone(), log.input.clone());
    let start_s = log.time_s[0];
    let mut carried: State = model.at_rest(log.position[0], start_s);
    let mut predicted = Vec::with_capacity(log.position.len());
    let mut row = 0;
    for (window, truth) in log.restarts.iter().enumerate() {
        let from_s = start_s + window as f64 * restart.horizon_s;
        let to_s = from_s + restart.horizon_s;
        let [shown, slope, bend] = restart_state(log, from_s, restart.half_width_s);
        let x = shown + restart.logged_lag_s * slope;
        let v = slope + restart.logged_lag_s * bend;
        let mut state = match hidden {
            HiddenStates::Known => truth.clone(),
            HiddenStates::Carried => carried.clone(),
        };
        state.time_s = from_s;
        let dx = x - model.reading(&state, run);
        let dv = v - model.reading_rate(&state);
        model.displace(&mut state, dx, dv);
        let mut passed = shown;
        // Restart times are sums with rounding errors. A row at the restart belongs to the window that starts there.
        while row < log.time_s.len() && log.time_s[row] < to_s - 1e-9 {
            model.advance(&mut state, &series, run, log.time_s[row], step_s);
            let reading = model.reading(&state, run);
            if log.time_s[row] > from_s + 1e-9 {
                passed += restart.logged_gain * (reading - passed);
            }
            predicted.push(if restart.logged_gain < 1.0 {
                passed
            } else {
                reading
            });
            row += 1;
        }
        model.advance(&mut state, &series, run, to_s, step_s);
        carried = state;
    }
    predicted.resize(log.position.len(), f64::NAN);
    predicted
}

/// Value, slope and second derivative at `at_s` of the cubic fitted to the samples around it.
fn restart_state(log: &Log, at_s: f64, half_width_s: f64) -> [f64; 3] {
    let n = log.time_s.len();
    let slack = 1e-9;
    let mut from = log
        .time_s
        .partition_point(|t| *t < at_s - half_width_s - slack);
    let mut to = log
        .time_s
        .partition_point(|t| *t <= at_s + half_width_s + slack);
    while to - from < FEWEST_SAMPLES.min(n) {
        let left = (from > 0).then(|| at_s - log.time_s[from - 1]);
        let right = (to < n).then(|| log.time_s[to] - at_s);
        match (left, right) {
            (Some(l), Some(r)) if l <= r => from -= 1,
            (Some(_), None) => from -= 1,
            (_, Some(_)) => to += 1,
            (None, None) => break,
        }
    }
    let scale = (log.time_s[to - 1] - at_s)
        .abs()
        .max((at_s - log.time_s[from]).abs())
        .max(1e-9);
    let mut normal = [[0.0; 5]; 4];
    for k in from..to {
        let u = (log.time_s[k] - at_s) / scale;
        let powers = [1.0, u, u * u, u * u * u];
        for i in 0..4 {
            for j in 0..4 {
                normal[i][j] += powers[i] * powers[j];
            }
            normal[i][4] += powers[i] * log.position[k];
        }
    }
    let c = solve(normal);
    [c[0], c[1] / scale, 2.0 * c[2] / (scale * scale)]
}

/// Solves a 4 × 4 linear system by Gaussian elimination with pivoting.
fn solve(mut a: [[f64; 5]; 4]) -> [f64; 4] {
    for i in 0..4 {
        let pivot = (i..4)
            .max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))
            .unwrap_or(i);
        a.swap(i, pivot);
        for j in 0..4 {
            if j != i {
                let factor = a[j][i] / a[i][i];
                let row = a[i];
                for (value, above) in a[j].iter_mut().zip(row) {
                    *value -= factor * above;
                }
            }
        }
    }
    std::array::from_fn(|i| a[i][4] / a[i][i])
}

/// Root mean square of the difference between predicted and logged positions.
pub(crate) fn gap(logs: &[Log], predicted: &[Vec<f64>]) -> f64 {
    rms(logs.iter().zip(predicted).flat_map(|(log, run)| {
        log.position
            .iter()
            .zip(run)
            .map(|(measured, predicted)| measured - predicted)
    }))
}

/// Root mean square difference between two sets of predictions.
pub(crate) fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    rms(a
        .iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| a - b))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    f64::sqrt(sum / f64::max(count, 1.0))
}
