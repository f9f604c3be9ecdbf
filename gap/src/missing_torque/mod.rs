//! The torque that a model lacks over time, estimated from a recording alone, and what may explain it.
//!
//! A smoother with an unknown input turns the measured position into a torque with its standard deviation; no effect has to be
//! named for that. Every effect of the library is then a torque along the smoothed motion, which goes through the same
//! smoother, so that both sides are smoothed alike; least squares over blocks of time say which sets of effects explain the
//! missing torque, and with which numbers. That takes milliseconds and proposes; it does not decide.

pub(crate) mod axis;
mod estimate;
pub(crate) mod form;
pub(crate) mod lateness;
mod load;
mod look;
pub(crate) mod misreading;
mod numbers;
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

use crate::windows::excerpt::excerpt;
use estimate::{Estimate, estimate};
use host_sim::device::Device;
use load::of_one_load;
use path::Path;
use recording::Recording;
use regression::{FOLDS, Rows};
use ripple::Waves;
use samples::{Samples, nominal_drive};
use shortlist::Field;
use smoother::Steps;
use table::{Table, TableAxis};
use target::Target;

pub use axis::Axis;
pub use look::{Look, Point, Summary};
pub use orders::Order;
pub use shares::Share;
pub use shortlist::Proposal;

/// Share of the missing torque's rms that a model of it is off by anyway: a small part that is known very well must not decide.
const MODEL_ERROR: f64 = 0.1;
/// Rows of a fit in a time constant of the smoother.
const ROWS_A_CONSTANT: f64 = 2.0;
/// Rows of a recording that are looked at, in stretches of whole windows where it has more.
const MOST_ROWS: usize = 200_000;
/// Length of a block of time that is held out as a whole, in horizons, and in time constants of the smoother at least.
const BLOCK_HORIZONS: f64 = 0.37;
const BLOCK_CONSTANTS: f64 = 5.0;

/// The torque that a device lacks along a recording.
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
    /// The run's CSV file.
    pub file: String,
    /// In the run's time, s.
    pub time_s: Vec<f64>,
    /// In units of input times the ratio.
    pub torque: Vec<f64>,
    /// Standard deviation, likewise.
    pub std: Vec<f64>,
}

impl MissingTorque {
    /// What `device` lacks along `recording`, or along stretches spread evenly over a long one. Where runs differ in their load, along
    /// those of the load with the most rows.
    pub fn of(recording: &Recording, device: &Device) -> Self {
        let one = of_one_load(recording);
        let device = &device.with_load(&recording.model, &one.model);
        let recording = excerpt(&one, MOST_ROWS).into_owned();
        let samples = Samples::of(&recording);
        let drive = nominal_drive(&samples, device);
        let estimate = estimate(&samples, device, &drive, recording.horizon);
        Self {
            recording,
            device: device.clone(),
            samples,
            drive,
            estimate,
        }
    }

    /// A table of it over the axis that carries it best of those that a table may be over; none where no such axis carries a part of it.
    pub(crate) fn table(&self) -> Option<Table> {
        let shares = self.summary().shares.into_iter();
        let mut axes = shares.filter(|share| share.share > 0.0);
        let axis = axes.find_map(|share| TableAxis::of(share.axis))?;
        Table::fitted(axis, &self.points(), self.device.drive.ratio)
    }

    /// The torque over time, a run after the other.
    pub fn runs(&self) -> Vec<MissingRun> {
        let mut runs: Vec<MissingRun> = Vec::new();
        for stretch in &self.samples.stretches {
            let file = &self.recording.runs[stretch.run].file;
            let goes_on = runs.last().is_some_and(|run| {
                let first_s = self.samples.time_s.get(stretch.rows.start);
                run.file == *file && run.time_s.last() < first_s
            });
            if !goes_on {
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

    /// The `count` sets of effects that explain it best, the best first.
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
        Field::of(&self.recording, &path, &smoother, &rows, &target).shortlist(count)
    }

    /// The orders of a ripple in it, the largest first.
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

    /// Weights of a fit at all rows, 0 where it does not see one.
    fn weights(&self, rows: &Rows) -> Vec<f64> {
        let mut weights = vec![0.0; self.samples.len()];
        let pairs = rows.rows.iter().zip(&rows.weight);
        pairs.for_each(|(&row, weight)| weights[row] = *weight);
        weights
    }

    /// Of the smoother, rad/s.
    fn corner(&self) -> f64 {
        self.estimate.noise.corner / self.samples.period_s
    }

    /// Rows that a fit sees, in blocks of about `block_s` that are dealt to the folds.
    fn rows(&self, block_s: f64) -> Rows {
        let smoothed = &self.estimate.smoothed;
        let corner = self.estimate.noise.corner;
        let constant = core::f64::consts::PI / corner;
        let every = (constant / ROWS_A_CONSTANT).floor().max(1.0) as usize;
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
            // The smoother sees the ends from one side only.
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

    /// Root mean square where the direction of sliding is known, in units of input times the ratio.
    pub fn rms(&self) -> f64 {
        let pairs = self
            .estimate
            .smoothed
            .torque
            .iter()
            .zip(&self.estimate.sliding);
        let known = pairs
            .filter(|(_, slides)| **slides)
            .map(|(torque, _)| torque * torque);
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), square| {
            (sum + square, count + 1.0)
        });
        (sum / f64::max(count, 1.0)).sqrt()
    }
}
