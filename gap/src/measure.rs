//! The gap of one model on one recording, and the floor below which no model can bring it.

use crate::predict::Predictor;
use crate::series::{self, Series};
use host_sim::device::Device;
use recording::Recording;
use serde::Serialize;

/// Gap and floor, root mean squares over all samples of all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Of the model as given, in units of position.
    pub before: f64,
    /// What noise, quantising and restarts alone leave, in units of position.
    pub floor: f64,
    /// Of position.
    pub unit: String,
}

/// A run with what the model made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedRun {
    /// The run's CSV file.
    pub file: String,
    /// s.
    pub time: Vec<f64>,
    /// In units of position.
    pub measured: Vec<f64>,
    /// In units of position.
    pub predicted: Vec<f64>,
}

/// Measures the gap of `device` on `recording` as the recording format defines it.
pub fn measure(recording: &Recording, device: &Device) -> (Gap, Vec<PredictedRun>) {
    let predictor = Predictor::new(device.clone(), recording);
    let mut squares = Mean::default();
    let mut floor = Mean::default();
    let mut runs = Vec::new();
    for series in series::full(recording, recording.horizon) {
        let predicted = predictor.predict(&series);
        for (p, m) in predicted.iter().zip(&series.position) {
            squares.add((p - m).powi(2));
        }
        for variance in perfect_variance(&predictor, &series, &predicted) {
            floor.add(variance);
        }
        runs.push(PredictedRun {
            file: recording.runs[series.run].file.clone(),
            time: series.time,
            measured: series.position,
            predicted,
        });
    }
    let gap = Gap {
        before: squares.mean().sqrt(),
        floor: floor.mean().sqrt(),
        unit: recording.units.position.clone(),
    };
    (gap, runs)
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

/// Displacement, in standard deviations, by which the sensitivity to a restart is taken: of the size
/// of the errors themselves, as stick and slip make it anything but linear.
pub(crate) const SENSITIVITY_SHIFT: f64 = 0.7;

/// Sensitivity of each prediction to value and slope of its restart, in standard deviations of them.
pub(crate) fn restart_sensitivity(
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

/// Variance of prediction minus measurement, sample by sample, if the model were perfect: the sensor's
/// noise, and that of the restart grown over the window, which near the restart are the same noise.
pub(crate) fn perfect_variance(
    predictor: &Predictor,
    series: &Series,
    predicted: &[f64],
) -> Vec<f64> {
    let sensitivity = restart_sensitivity(predictor, series, predicted, |_| true);
    let mut variance = Vec::with_capacity(predicted.len());
    for window in &series.windows {
        let fit = &window.restart;
        let sd = [0, 1].map(|i| fit.covariance[i][i].sqrt());
        let correlation = fit.covariance[0][1] / (sd[0] * sd[1]);
        for i in window.samples.clone() {
            let [a, b] = sensitivity[i];
            let restart = a * a + b * b + 2.0 * correlation * a * b;
            let common = if fit.covers(series.time[i]) {
                let [value, slope] = fit.influence(series.time[i]);
                2.0 * window.restart_noise * (a * value / sd[0] + b * slope / sd[1])
            } else {
                0.0
            };
            variance.push((restart + window.noise.powi(2) - common).max(0.0));
        }
    }
    variance
}
