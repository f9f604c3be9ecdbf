//! The gap of a model on a recording, and the floor below which no model can reduce it.

use crate::floor::{SAMPLED_WINDOWS, floor_squares};
use crate::predict::Predictor;
use crate::windows::series::{self, Series, Window};
use crate::windows::unbroken::Unbroken;
use host_sim::device::Device;
use recording::Recording;
use serde::Serialize;

/// Gap and floor: rms over all samples of all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Gap of the given model, in position units.
    pub before: f64,
    /// Expected gap of an exact model, from noise, quantization and restarts, in position units.
    pub floor: f64,
    /// Unit of the position.
    pub unit: String,
}

/// A run with its prediction by the model.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedRun {
    /// CSV file of the run.
    pub file: String,
    /// Time of the samples, s.
    pub time: Vec<f64>,
    /// In units of position.
    pub measured: Vec<f64>,
    /// In units of position.
    pub predicted: Vec<f64>,
}

/// Ratio of gap to floor beyond which a rough estimate of the floor suffices.
const FAR_ABOVE: f64 = 3.0;
/// Number of windows of a rough estimate. Two draws are made in any case.
const ROUGH: usize = 1;

/// Measures the gap of `device` on `recording` as the recording format defines it. The prediction restarts after gaps in the rows that
/// are longer than a restart spans.
pub fn measure(recording: &Recording, device: &Device) -> (Gap, Vec<PredictedRun>) {
    let Unbroken {
        recording: unbroken,
        runs,
    } = &Unbroken::of(recording);
    let mut parts = Vec::new();
    let residual = Residual::passed_to(unbroken, device, |series, predicted| {
        parts.push(PredictedRun {
            file: unbroken.runs[series.run].file.clone(),
            time: series.time,
            measured: series.position,
            predicted,
        });
    });
    let gap = Gap {
        before: residual.rms,
        // A gap below the floor is due to chance, so the floor is at most the gap.
        floor: residual.floor(unbroken, SAMPLED_WINDOWS).min(residual.rms),
        unit: recording.units.position.clone(),
    };
    (gap, whole(parts, runs))
}

/// Joins the parts of each run. `runs` holds the run of each part.
fn whole(parts: Vec<PredictedRun>, runs: &[usize]) -> Vec<PredictedRun> {
    let mut whole: Vec<PredictedRun> = Vec::new();
    let mut last = None;
    for (part, run) in parts.into_iter().zip(runs) {
        match whole.last_mut().filter(|_| last == Some(run)) {
            Some(before) => {
                before.time.extend(part.time);
                before.measured.extend(part.measured);
                before.predicted.extend(part.predicted);
            }
            None => whole.push(part),
        }
        last = Some(run);
    }
    whole
}

/// Gap of `device`, in position units, and whether it exceeds `floors` times its floor.
pub(crate) fn exceeds(recording: &Recording, device: &Device, floors: f64) -> (f64, bool) {
    let residual = Residual::of(recording, device);
    let beyond = |times: f64, sampled_windows| {
        residual.rms > times * residual.floor(recording, sampled_windows)
    };
    let exceeds = beyond(floors.max(FAR_ABOVE), ROUGH) || beyond(floors, SAMPLED_WINDOWS);
    (residual.rms, exceeds)
}

/// The residual of a device on a recording at full rate.
pub(crate) struct Residual {
    predictor: Predictor,
    /// Windows with the index of their run.
    windows: Vec<(usize, Window)>,
    /// Sum of squared residuals of each window, in position units squared.
    pub squares: Vec<f64>,
    /// Rms over all samples, in position units.
    pub rms: f64,
}

impl Residual {
    pub fn of(recording: &Recording, device: &Device) -> Self {
        Self::passed_to(recording, device, |_, _| {})
    }

    /// Computes the residual, and passes each run with its prediction to `receive`, which may keep them. Only one run at a time is held
    /// at full rate.
    fn passed_to(
        recording: &Recording,
        device: &Device,
        mut receive: impl FnMut(Series, Vec<f64>),
    ) -> Self {
        let predictor = Predictor::new(device.clone(), recording);
        let (mut squares, mut windows) = (Vec::new(), Vec::new());
        for mut series in series::each_full(recording, recording.horizon) {
            let predicted = predictor.predict(&series);
            let residual = |window| series.squares(window, &predicted);
            squares.extend(series.windows.iter().map(residual));
            let of_run = std::mem::take(&mut series.windows).into_iter();
            windows.extend(of_run.map(|window| (series.run, window)));
            receive(series, predicted);
        }
        Self {
            rms: rms(&squares, samples(&windows)),
            squares,
            predictor,
            windows,
        }
    }

    fn floor(&self, recording: &Recording, sampled_windows: usize) -> f64 {
        let windows = self.windows.iter().map(|(run, window)| (*run, window));
        let floor = floor_squares(
            recording,
            &self.predictor,
            windows,
            series::full,
            sampled_windows,
        );
        rms(&floor, samples(&self.windows))
    }
}

fn samples(windows: &[(usize, Window)]) -> usize {
    windows.iter().map(|(_, window)| window.samples.len()).sum()
}

fn rms(squares: &[f64], samples: usize) -> f64 {
    (squares.iter().sum::<f64>() / samples.max(1) as f64).sqrt()
}
