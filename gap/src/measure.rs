//! The gap of one model on one recording, and the floor below which no model can bring it.

use crate::floor::{SAMPLED_WINDOWS, floor_squares};
use crate::predict::Predictor;
use crate::windows::series::{self, Series, Window};
use crate::windows::unbroken::Unbroken;
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

/// Gap over floor beyond which a glance at the floor is enough.
const FAR_BEYOND: f64 = 3.0;
/// Windows that are looked at for that: those of a draw to either side.
const GLANCE: usize = 1;

/// Measures the gap of `device` on `recording` as the recording format defines it; where rows are missing for longer than a
/// restart looks, prediction begins anew.
pub fn measure(recording: &Recording, device: &Device) -> (Gap, Vec<PredictedRun>) {
    let Unbroken {
        recording: unbroken,
        runs,
    } = &Unbroken::of(recording);
    let mut parts = Vec::new();
    let left = Left::told(unbroken, device, |series, predicted| {
        parts.push(PredictedRun {
            file: unbroken.runs[series.run].file.clone(),
            time: series.time,
            measured: series.position,
            predicted,
        });
    });
    let gap = Gap {
        before: left.rms,
        // A device that leaves less than an replicate one did was luckier with its restarts.
        floor: left.floor(unbroken, SAMPLED_WINDOWS).min(left.rms),
        unit: recording.units.position.clone(),
    };
    (gap, whole(parts, runs))
}

/// The parts of each run put together; `runs` tells of which each is one.
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

/// What `device` leaves, in units of position, and whether that is more than `floors` times its floor.
pub(crate) fn exceeds(recording: &Recording, device: &Device, floors: f64) -> (f64, bool) {
    let left = Left::of(recording, device);
    let beyond = |times: f64, looked_at| left.rms > times * left.floor(recording, looked_at);
    let exceeds = beyond(floors.max(FAR_BEYOND), GLANCE) || beyond(floors, SAMPLED_WINDOWS);
    (left.rms, exceeds)
}

/// What a device leaves of a recording at full rate.
pub(crate) struct Left {
    predictor: Predictor,
    /// With their runs.
    windows: Vec<(usize, Window)>,
    /// Sums over each window, in units of position squared.
    pub squares: Vec<f64>,
    /// Over all samples, in units of position.
    pub rms: f64,
}

impl Left {
    pub fn of(recording: &Recording, device: &Device) -> Self {
        Self::told(recording, device, |_, _| {})
    }

    /// The same, with each run and what was predicted of it given to `told`, which is all that keeps them: one run at a time is
    /// held at full rate.
    fn told(
        recording: &Recording,
        device: &Device,
        mut told: impl FnMut(Series, Vec<f64>),
    ) -> Self {
        let predictor = Predictor::new(device.clone(), recording);
        let (mut squares, mut windows) = (Vec::new(), Vec::new());
        for mut series in series::each_full(recording, recording.horizon) {
            let predicted = predictor.predict(&series);
            let left = |window| series.squares(window, &predicted);
            squares.extend(series.windows.iter().map(left));
            let of_run = std::mem::take(&mut series.windows).into_iter();
            windows.extend(of_run.map(|window| (series.run, window)));
            told(series, predicted);
        }
        Self {
            rms: rms(&squares, samples(&windows)),
            squares,
            predictor,
            windows,
        }
    }

    fn floor(&self, recording: &Recording, looked_at: usize) -> f64 {
        let windows = self.windows.iter().map(|(run, window)| (*run, window));
        let floor = floor_squares(recording, &self.predictor, windows, series::full, looked_at);
        rms(&floor, samples(&self.windows))
    }
}

fn samples(windows: &[(usize, Window)]) -> usize {
    windows.iter().map(|(_, window)| window.samples.len()).sum()
}

fn rms(squares: &[f64], samples: usize) -> f64 {
    (squares.iter().sum::<f64>() / samples.max(1) as f64).sqrt()
}
