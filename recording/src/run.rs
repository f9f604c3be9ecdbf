//! One run: recorded samples by column.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::statistics::{median, quantile};

/// Least period of a gap, over the median period. It must also be [`GAP_TAILS`] times the quantile [`JITTERED`] of the
/// periods, so that jitter is not a gap. If more than one row in ten is followed by a gap, there are too few rows between
/// gaps for a restart.
const GAP_MEDIANS: f64 = 5.0;
/// Least period of a gap over a high quantile of the periods, see [`GAP_MEDIANS`].
const GAP_TAILS: f64 = 2.0;
/// That quantile, see [`GAP_MEDIANS`].
const JITTERED: f64 = 0.9;

/// Source of the input: prescribed or from a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// The input is a function of time.
    OpenLoop,
    /// The input is a function of the measured position.
    ClosedLoop,
}

/// How `input` was sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputSampling {
    /// Its mean from this row until the next.
    #[default]
    Mean,
    /// Its value at the time of the row. It is interpolated linearly between rows and constant after the last.
    Point,
}

impl InputSampling {
    /// Its name in the manifest.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Point => "point",
        }
    }
}

/// The controller of a closed-loop run, from position error to input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pid {
    /// Input per unit of position error.
    pub kp: f64,
    /// Input per unit of position error and per second.
    #[serde(default)]
    pub ki: f64,
    /// Input per unit of velocity.
    #[serde(default)]
    pub kd: f64,
    /// Period of the loop, s.
    pub period: f64,
    /// Corner frequency of the first-order low-pass on the measured position, Hz. `None` is no low-pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_cutoff_hz: Option<f64>,
}

/// One run. All columns are as long as `time`.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name of the CSV file inside the folder.
    pub file: String,
    /// Source of the input.
    pub drive: Drive,
    /// Standard deviation of the unknown time between input and position column, s. Above 0 the time is estimated.
    pub input_time_std: f64,
    /// How the input was sampled.
    pub input_sampling: InputSampling,
    /// The controller, if stated.
    pub controller: Option<Pid>,
    /// Model numbers that differ in this run, for example with another load. See [`Recording::model_of`].
    ///
    /// [`Recording::model_of`]: crate::Recording::model_of
    pub numbers: BTreeMap<String, f64>,
    /// Time of each row, s, strictly increasing.
    pub time: Vec<f64>,
    /// Command of the actuator, in units of input, sampled as [`input_sampling`](Self::input_sampling) says.
    pub input: Vec<f64>,
    /// Position that the model must predict, in units of position.
    pub position: Vec<f64>,
    /// Setpoint of the position, in units of position.
    pub setpoint: Option<Vec<f64>>,
    /// Readings of other sensors of the same position by column, such as `position_hall`, in units of position.
    pub positions: BTreeMap<String, Vec<f64>>,
    /// Actuator current. It is in single precision, like the next two columns, to save memory in long runs.
    pub current: Option<Vec<f32>>,
    /// Supply voltage.
    pub supply: Option<Vec<f32>>,
    /// Temperature.
    pub temperature: Option<Vec<f32>>,
    /// Names of other columns. They are neither loaded nor written.
    pub ignored: Vec<String>,
}

impl Run {
    /// A run with the three required columns.
    pub fn new(
        file: impl Into<String>,
        drive: Drive,
        time: Vec<f64>,
        input: Vec<f64>,
        position: Vec<f64>,
    ) -> Self {
        Self {
            file: file.into(),
            drive,
            input_time_std: 0.0,
            input_sampling: InputSampling::Mean,
            controller: None,
            numbers: BTreeMap::new(),
            time,
            input,
            position,
            setpoint: None,
            positions: BTreeMap::new(),
            current: None,
            supply: None,
            temperature: None,
            ignored: Vec::new(),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True if the run has no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// A part of the run.
    ///
    /// # Panics
    ///
    /// If the range exceeds the run.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        let rows: Vec<usize> = rows.collect();
        self.columns_at(&rows)
    }

    /// The run reduced to some of its rows, in their order. Mean inputs are averaged until the next of these rows.
    pub(crate) fn rows(&self, rows: &[usize]) -> Self {
        if self.input_sampling == InputSampling::Point {
            return self.columns_at(rows);
        }
        let periods = self.periods();
        let ends = rows.iter().skip(1).copied().chain([self.len()]);
        let inputs = rows.iter().zip(ends).map(|(&from, to)| {
            // The last row is assumed to have the usual duration.
            let lasts_s = |row: usize| periods.get(row).or(periods.last()).copied().unwrap_or(1.0);
            let told: f64 = (from..to).map(|row| lasts_s(row) * self.input[row]).sum();
            told / (from..to).map(lasts_s).sum::<f64>()
        });
        Self {
            input: inputs.collect(),
            ..self.columns_at(rows)
        }
    }

    fn columns_at(&self, rows: &[usize]) -> Self {
        let of = |column: &Vec<f64>| rows.iter().map(|&row| column[row]).collect::<Vec<_>>();
        let narrow = |column: &Option<Vec<f32>>| {
            let column = column.as_ref();
            column.map(|column| rows.iter().map(|&row| column[row]).collect())
        };
        let positions = self.positions.iter();
        Self {
            file: self.file.clone(),
            drive: self.drive,
            input_time_std: self.input_time_std,
            input_sampling: self.input_sampling,
            controller: self.controller,
            numbers: self.numbers.clone(),
            time: of(&self.time),
            input: of(&self.input),
            position: of(&self.position),
            setpoint: self.setpoint.as_ref().map(of),
            positions: positions
                .map(|(name, column)| (name.clone(), of(column)))
                .collect(),
            current: narrow(&self.current),
            supply: narrow(&self.supply),
            temperature: narrow(&self.temperature),
            ignored: self.ignored.clone(),
        }
    }

    /// Indices of the rows before gaps.
    pub fn gaps(&self) -> Vec<usize> {
        let periods = self.periods();
        let least_s = (GAP_MEDIANS * median(periods.clone()))
            .max(GAP_TAILS * quantile(periods.clone(), JITTERED));
        let periods = periods.iter().enumerate();
        let gaps = periods.filter(|(_, period)| **period > least_s);
        gaps.map(|(row, _)| row).collect()
    }

    /// Time from each sample to the next, s.
    pub(crate) fn periods(&self) -> Vec<f64> {
        self.time.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    /// Time from the first to the last sample, s.
    pub fn duration_s(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}
