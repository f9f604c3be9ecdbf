//! One run: a stretch of recorded samples, by column.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::statistics::{median, quantile};

/// A gap: a period of this many medians, and of [`GAP_TAILS`] times what jitter reaches, the quantile [`JITTERED`], so that jitter
/// is none. Where more than one row in ten is followed by a gap, too few are left between two to restart from.
const GAP_MEDIANS: f64 = 5.0;
/// See [`GAP_MEDIANS`].
const GAP_TAILS: f64 = 2.0;
/// See [`GAP_MEDIANS`].
const JITTERED: f64 = 0.9;

/// Where the input came from: prescribed, or from a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// The input is a function of time.
    OpenLoop,
    /// The input is a function of the measured position.
    ClosedLoop,
}

/// How a row's `input` was sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputSampling {
    /// Its mean until then.
    #[default]
    Mean,
    /// Its value at the row's instant. Between rows it then goes in a straight line; after the last it stays.
    Point,
}

impl InputSampling {
    /// Its name in a manifest.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Point => "point",
        }
    }
}

/// The controller of a closed-loop run: input from position error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pid {
    /// Input per unit of position error.
    pub kp: f64,
    /// Input per unit of position error and second.
    #[serde(default)]
    pub ki: f64,
    /// Input per unit of position and per second.
    #[serde(default)]
    pub kd: f64,
    /// Period of the loop, s.
    pub period: f64,
    /// Corner of the first-order low-pass on the measured position, Hz; `None` is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_cutoff_hz: Option<f64>,
}

/// One run. All columns have the length of `time`.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name of the CSV file inside the folder.
    pub file: String,
    /// Where the input came from.
    pub drive: Drive,
    /// Standard deviation of the time between input and position, s; above 0 where that is not known: it is estimated then.
    pub input_time_std: f64,
    /// How the input was sampled.
    pub input_sampling: InputSampling,
    /// The controller, if it is stated.
    pub controller: Option<Pid>,
    /// Numbers of the model that are other in this run, such as another load; see [`Recording::model_of`].
    ///
    /// [`Recording::model_of`]: crate::Recording::model_of
    pub numbers: BTreeMap<String, f64>,
    /// Time of each row, s, strictly increasing.
    pub time: Vec<f64>,
    /// Command of the actuator, in units of input, sampled as [`input_sampling`](Self::input_sampling) says.
    pub input: Vec<f64>,
    /// Position with which the model is compared, in units of position.
    pub position: Vec<f64>,
    /// Setpoint of the position, in units of position.
    pub setpoint: Option<Vec<f64>>,
    /// Readings of further sensors of the same position, by column: `position_hall`, …; in units of position.
    pub positions: BTreeMap<String, Vec<f64>>,
    /// Actuator current. Single precision, like the next two: no such sensor has more digits, and long runs fit.
    pub current: Option<Vec<f32>>,
    /// Supply voltage.
    pub supply: Option<Vec<f32>>,
    /// Temperature.
    pub temperature: Option<Vec<f32>>,
    /// Names of the other columns. They stay in the file: neither loaded nor written.
    pub ignored: Vec<String>,
}

impl Run {
    /// A run of the three columns that every run has.
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

    /// Whether the run has no sample.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The rows of a stretch.
    ///
    /// # Panics
    /// If they are not all there.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        let rows: Vec<usize> = rows.collect();
        self.columns_at(&rows)
    }

    /// Some of its rows, in their order, the input of each averaged until the next, unless it is of an instant.
    pub(crate) fn rows(&self, rows: &[usize]) -> Self {
        if self.input_sampling == InputSampling::Point {
            return self.columns_at(rows);
        }
        let periods = self.periods();
        let ends = rows.iter().skip(1).copied().chain([self.len()]);
        let inputs = rows.iter().zip(ends).map(|(&from, to)| {
            // The last row lasts as long as any.
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

    /// Indices of the rows after which rows are missing.
    pub fn gaps(&self) -> Vec<usize> {
        let periods = self.periods();
        let least_s = (GAP_MEDIANS * median(periods.clone()))
            .max(GAP_TAILS * quantile(periods.clone(), JITTERED));
        let periods = periods.iter().enumerate();
        let gaps = periods.filter(|(_, period)| **period > least_s);
        gaps.map(|(row, _)| row).collect()
    }

    /// From each sample to the next, s.
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
