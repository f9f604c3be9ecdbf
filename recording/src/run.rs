//! One run: a stretch of recorded samples, by column.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Whether the input was prescribed or came from a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// The input is a function of time.
    OpenLoop,
    /// The input is a function of the measured position.
    ClosedLoop,
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
    /// How the input came about.
    pub drive: Drive,
    /// Standard deviation of the input's alignment in time, s; above 0 where it was reconstructed.
    pub input_time_std: f64,
    /// The loop, if it is stated.
    pub controller: Option<Pid>,
    /// s, strictly increasing.
    pub time: Vec<f64>,
    /// What the actuator was told, averaged until the next row and held.
    pub input: Vec<f64>,
    /// The position that the model is compared with.
    pub position: Vec<f64>,
    /// What the position was to be.
    pub setpoint: Option<Vec<f64>>,
    /// Further sensors of the same position, by column: `position_hall`, …
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
            controller: None,
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

    /// Without its first row, if it has any.
    pub(crate) fn drop_first(&mut self) {
        if self.is_empty() {
            return;
        }
        self.time.remove(0);
        self.input.remove(0);
        self.position.remove(0);
        let further = self.positions.values_mut();
        for column in self.setpoint.iter_mut().chain(further) {
            column.remove(0);
        }
        let narrow = [&mut self.current, &mut self.supply, &mut self.temperature];
        for column in narrow.into_iter().flatten() {
            column.remove(0);
        }
    }

    /// Time from the first to the last sample, s.
    pub fn duration_s(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}
