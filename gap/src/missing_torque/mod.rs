//! Estimates the torque that a model lacks over time from a recording alone, and proposes explanations.
//!
//! A smoother with an unknown input turns the measured position into a missing torque with its standard deviation, without an assumption
//! about its cause. The torque of each effect of the library along the smoothed motion passes through the same smoother, so both sides
//! are smoothed equally. Least squares over blocks of time then show which sets of effects explain the missing torque, and with which
//! parameters. That takes milliseconds and only proposes effects; the diagnosis decides.

pub(crate) mod axis;
pub(crate) mod delay_forms;
mod estimate;
pub(crate) mod form;
mod look;
pub(crate) mod misreading;
mod one_load;
mod orders;
pub(crate) mod path;
mod regression;
mod repeats;
mod ripple;
mod samples;
mod shares;
mod shortlist;
mod smoother;
pub mod table;
pub(crate) mod target;
mod tolerances;

use crate::windows::excerpt::excerpt;
use estimate::{Estimate, estimate};
use host_sim::device::Device;
use one_load::of_one_load;
use path::Path;
use recording::Recording;
use regression::{FOLDS, Rows};
use ripple::Waves;
use samples::Samples;
use shortlist::ShortlistSearch;
use smoother::Steps;
use table::{Table, TableAxis};
use target::Target;

pub use axis::Axis;
pub use look::{Look, Point, Summary};
pub use orders::Order;
pub use shares::Share;
pub use shortlist::Proposal;

/// Model error of any explanation, as a share of the rms missing torque. It limits the weight of instants with a small standard
/// deviation.
const MODEL_ERROR: f64 = 0.1;
/// Number of fitted rows per time constant of the smoother.
const ROWS_PER_CONSTANT: f64 = 2.0;
/// Largest number of rows that are used. Of a longer recording, parts of whole windows are used.
const MOST_ROWS: usize = 200_000;
/// Length of a held-out block of time, in horizons, and its least length in time constants of the smoother.
const BLOCK_HORIZONS: f64 = 0.37;
const BLOCK_CONSTANTS: f64 = 5.0;

/// The missing torque of a device along a recording.
#[derive(Clone, Debug)]
pub struct MissingTorque {
    recording: Recording,
    device: Device,
    samples: Samples,
    drive: Vec<f64>,
    estimate: Estimate,
}

/// The missing torque of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingRun {
    /// CSV file of the run.
    pub file: String,
    /// Time of the run, s.
    pub time_s: Vec<f64>,
    /// Missing torque, in input units times the ratio of the drive.
    pub torque: Vec<f64>,
    /// Standard deviation of the missing torque, in the same unit.
    pub std: Vec<f64>,
}

impl MissingTorque {
    /// Estimates the missing torque of `device` along `recording`, or along evenly spread parts of a long recording. If the runs differ
    /// in their load, it uses the runs of the load with the most rows.
    pub fn of(recording: &Recording, device: &Device) -> Self {
        let one = of_one_load(recording);
        let device = &device.with_load(&recording.model, &one.model);
        let recording = excerpt(&one, MOST_ROWS).into_owned();
        let samples = Samples::of(&recording);
        let drive = samples.drive(&device.drive);
        let estimate = estimate(&samples, device, &drive, recording.horizon);
        Self {
            recording,
            device: device.clone(),
            samples,
            drive,
            estimate,
        }
    }

    /// A table of the missing torque over the axis that explains most of it. Returns `None` if no axis that a table may have explains a
    /// part of it.
    pub(crate) fn table(&self) -> Option<Table> {
        let shares = self.summary().shares.into_iter();
        let mut axes = shares.filter(|share| share.share > 0.0);
        let axis = axes.find_map(|share| TableAxis::of(share.axis))?;
        Table::fitted(axis, &self.points(), self.device.drive.ratio)
    }

    /// The missing torque over time, run by run.
    pub fn runs(&self) -> Vec<MissingRun> {
        let mut runs: Vec<MissingRun> = Vec::new();
        for stretch in &self.samples.stretches {
            let file = &self.recording.runs[stretch.run].file;
            let continues = runs.last().is_some_and(|run| {
                let first_s = self.samples.time_s.get(stretch.rows.start);
                run.file == *file && run.time_s.last() < first_s
            });
            if !continues {
                runs.push(MissingRun {
                    file: file.clone(),
                    time_s: Vec::new(),
                    torque: Vec::new(),
                    std: Vec::new(),
                });
            }
            if let Some(run) = runs.last_mut() {
                let rows = stretch.rows.clone();
                run.time_s.extend(&self.samples.time_s[rows.clone()]);
                run.torque
                    .extend(&self.estimate.smoothed.torque[rows.clone()]);
                run.std.extend(&self.estimate.smoothed.torque_std[rows]);
            }
        }
        runs
    }

    /// The `count` sets of effects that explain the missing torque best, best first.
    pub fn shortlist(&self, count: usize) -> Vec<Proposal> {
        let smoothed = &self.estimate.smoothed;
        let path = self.path();
        let rows = self.rows(BLOCK_HORIZONS * self.recording.horizon);
        let corner = self.corner();
        let waves = Waves::of(&path, &rows, &rows.of(&smoothed.torque), corner);
        let weight = self.weights(&rows);
        let target = Target {
            torque: &smoothed.torque,
            corner,
            rows: &rows.rows,
            weight: &weight,
            innovation: &smoothed.innovation,
            waves: &waves,
        };
        let steps = Steps::of(&self.samples, &self.device.mechanics);
        let sliding = &self.estimate.sliding;
        let smoother = steps.smoother(self.estimate.noise, &smoothed.velocity, sliding);
        ShortlistSearch::of(&self.recording, &path, &smoother, &rows, &target).shortlist(count)
    }

    /// The orders of a ripple in the missing torque, largest first.
    pub fn ripple(&self) -> Vec<Order> {
        let smoothed = &self.estimate.smoothed;
        let path = self.path();
        let rows = self.rows(BLOCK_HORIZONS * self.recording.horizon);
        let steps = Steps::of(&self.samples, &self.device.mechanics);
        let sliding = &self.estimate.sliding;
        let smoother = steps.smoother(self.estimate.noise, &smoothed.velocity, sliding);
        let torque = rows.of(&smoothed.torque);
        orders::orders(&path, &smoother, &rows, &torque, self.corner())
    }

    fn path(&self) -> Path<'_> {
        let (smoothed, sliding) = (&self.estimate.smoothed, &self.estimate.sliding);
        Path::along(&self.samples, &self.device, &self.drive, smoothed, sliding)
    }

    /// Weights of all rows in a fit; 0 for rows that are not fitted.
    fn weights(&self, rows: &Rows) -> Vec<f64> {
        let mut weights = vec![0.0; self.samples.len()];
        let pairs = rows.rows.iter().zip(&rows.weight);
        pairs.for_each(|(&row, weight)| weights[row] = *weight);
        weights
    }

    /// Corner frequency of the smoother, rad/s.
    fn corner(&self) -> f64 {
        self.estimate.noise.corner / self.samples.period_s
    }

    /// The rows of a fit, in blocks of about `block_s` that are assigned to the folds in turn.
    fn rows(&self, block_s: f64) -> Rows {
        let smoothed = &self.estimate.smoothed;
        let corner = self.estimate.noise.corner;
        let constant = core::f64::consts::PI / corner;
        let every = (constant / ROWS_PER_CONSTANT).floor().max(1.0) as usize;
        let independent = (every as f64 / constant).min(1.0);
        let known = |row: &usize| self.estimate.sliding[*row];
        let model_error = MODEL_ERROR * self.rms();
        let block_s = block_s.max(BLOCK_CONSTANTS * constant * self.samples.period_s);
        let mut rows = Rows {
            rows: Vec::new(),
            weight: Vec::new(),
            fold: Vec::new(),
        };
        let mut first_block = 0;
        for stretch in &self.samples.stretches {
            // At the ends the smoother has samples on one side only.
            let edge = (0.5 * constant).ceil() as usize;
            let inner = stretch.rows.start + edge..stretch.rows.end.saturating_sub(edge);
            let start_s = self.samples.time_s[stretch.rows.start];
            let mut block = first_block;
            for row in inner.step_by(every).filter(known) {
                block = first_block + ((self.samples.time_s[row] - start_s) / block_s) as usize;
                let variance = smoothed.torque_std[row].powi(2) + model_error * model_error;
                rows.rows.push(row);
                rows.weight
                    .push(independent / variance.max(f64::MIN_POSITIVE));
                rows.fold.push(block % FOLDS);
            }
            first_block = block + 1;
        }
        rows
    }

    /// Rms missing torque at the instants at which the direction of sliding is known, in input units times the ratio of the drive.
    pub fn rms(&self) -> f64 {
        let pairs = self
            .estimate
            .smoothed
            .torque
            .iter()
            .zip(&self.estimate.sliding);
        let known = pairs
            .filter(|(_, is_sliding)| **is_sliding)
            .map(|(torque, _)| torque * torque);
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), square| {
            (sum + square, count + 1.0)
        });
        (sum / f64::max(count, 1.0)).sqrt()
    }
}
