//! Two position columns of one motion, sample by sample.

use crate::windows::restart::Restart;
use crate::windows::series::Series;
use recording::{Recording, Run, low_pass_gain};
use std::ops::Range;

/// A stretch without gaps, with the readings of one column and the positions by the other.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub session_s: Vec<f64>,
    /// Position by local cubics through the reference column, with little noise.
    pub reference: Vec<f64>,
    /// The other column, unchanged.
    pub shown: Vec<f64>,
    /// Indices of the samples of each prediction window.
    pub windows: Vec<Range<usize>>,
}

impl Track {
    /// Velocity between consecutive samples, in position units per s.
    pub(crate) fn rates(&self) -> impl Iterator<Item = f64> {
        let times = self.session_s.windows(2).map(|pair| pair[1] - pair[0]);
        let steps = self.reference.windows(2).map(|pair| pair[1] - pair[0]);
        steps.zip(times).map(|(step, dt_s)| step / dt_s)
    }
}

/// Two columns of a recording.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    /// The tracks in the order of time.
    pub tracks: Vec<Track>,
    /// Variance of shown less reference from noise alone, in position units squared.
    pub variance: f64,
}

impl Columns {
    /// Pairs the readings `shown` with the positions by `reference`. `quanta` are the resolutions of both.
    pub(crate) fn of(
        reference: &[Series],
        shown: &[Series],
        half_width_s: f64,
        quanta: [f64; 2],
    ) -> Self {
        let mut tracks = Vec::new();
        let (mut variance, mut count) = (0.0, 0.0);
        for (reference, shown) in reference.iter().zip(shown) {
            let time = &reference.time;
            let cubic = |t: f64| Restart::fit(time, &reference.position, t, half_width_s);
            let Some(fits) = time.iter().map(|&t| cubic(t)).collect::<Option<Vec<_>>>() else {
                continue;
            };
            for (own, other) in reference.windows.iter().zip(&shown.windows) {
                let smoothed = fits[own.samples.start].covariance[0][0];
                let samples = own.samples.len() as f64;
                variance += samples * (own.noise.powi(2) * smoothed + other.noise.powi(2));
                count += samples;
            }
            tracks.push(Track {
                session_s: (0..time.len()).map(|i| reference.session(i)).collect(),
                reference: fits.iter().map(|fit| fit.value).collect(),
                shown: shown.position.clone(),
                windows: reference
                    .windows
                    .iter()
                    .map(|w| w.samples.clone())
                    .collect(),
            });
        }
        tracks.retain(|track| !track.session_s.is_empty());
        tracks.sort_by(|a, b| a.session_s[0].total_cmp(&b.session_s[0]));
        // At standstill the quantization error does not average out.
        let quantising = quanta.iter().map(|q| q * q / 12.0).sum::<f64>();
        Self {
            tracks,
            variance: (variance / f64::max(count, 1.0))
                .max(quantising)
                .max(f64::MIN_POSITIVE),
        }
    }
}

/// The recording as it is, and with `column` in place of `position`. Each passes the low-pass that the other one has passed already.
pub(crate) fn exchanged(recording: &Recording, column: &str) -> [Recording; 2] {
    let sensors = ["position", column].map(|name| recording.sensor(name));
    [0, 1].map(|which| {
        let mut own = Recording::new("", recording.horizon, recording.model);
        own.restart_half_width = recording.restart_half_width;
        own.sensors.insert("position".into(), sensors[which]);
        let runs = recording.runs.iter().map(|run| {
            let other = run.positions.get(column).filter(|_| which == 1);
            let position = other.unwrap_or(&run.position).clone();
            let position = match sensors[1 - which].cutoff_hz {
                Some(cutoff_hz) => filtered(&run.time, position, cutoff_hz),
                None => position,
            };
            let (time, input) = (run.time.clone(), run.input.clone());
            Run {
                input_time_std: run.input_time_std,
                input_sampling: run.input_sampling,
                numbers: run.numbers.clone(),
                ..Run::new("", run.drive, time, input, position)
            }
        });
        own.runs = runs.collect();
        own
    })
}

/// True if `run` has `column` and its value changes.
pub(crate) fn is_live(run: &Run, column: &str) -> bool {
    let changes = |shown: &Vec<f64>| shown.windows(2).any(|pair| pair[0] != pair[1]);
    run.positions.get(column).is_some_and(changes)
}

/// The column after the low-pass of the recording format.
fn filtered(time: &[f64], mut column: Vec<f64>, cutoff_hz: f64) -> Vec<f64> {
    for i in 1..column.len() {
        let gain = low_pass_gain(Some(cutoff_hz), time[i] - time[i - 1]);
        column[i] = column[i - 1] + gain * (column[i] - column[i - 1]);
    }
    column
}
