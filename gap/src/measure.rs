//! The gap of one model on one recording, and the floor below which no model can bring it.

use crate::floor::floor_squares;
use crate::predict::Predictor;
use crate::series;
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
    let (mut squares, mut windows, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    for series in series::full(recording, recording.horizon) {
        let predicted = predictor.predict(&series);
        let left = |window| series.squares(window, &predicted);
        squares.extend(series.windows.iter().map(left));
        windows.extend(series.windows.into_iter().map(|w| (series.run, w)));
        runs.push(PredictedRun {
            file: recording.runs[series.run].file.clone(),
            time: series.time,
            measured: series.position,
            predicted,
        });
    }
    let samples: usize = windows.iter().map(|(_, w)| w.samples.len()).sum();
    let before = rms(&squares, samples);
    let windows = windows.iter().map(|(run, window)| (*run, window));
    let floor = floor_squares(recording, &predictor, windows, series::full);
    let gap = Gap {
        before,
        // A device that leaves less than an imagined one did was luckier with its restarts.
        floor: rms(&floor, samples).min(before),
        unit: recording.units.position.clone(),
    };
    (gap, runs)
}

fn rms(squares: &[f64], samples: usize) -> f64 {
    (squares.iter().sum::<f64>() / samples.max(1) as f64).sqrt()
}
