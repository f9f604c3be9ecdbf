//! The recording format: a folder with one `recording.toml` and one CSV file per run.
//!
//! A [`Recording`] holds the input and the measured position of a device, and the nominal [`Model`] of the device. A
//! simulator creates and writes recordings. A diagnosis reads them. Bad input gives an [`Error`] of one line that names the
//! file, the row and the remedy. Minor problems are collected in [`Recording::oddities`].
//!
//! ```
//! use recording::{Drive, Model, Recording, Run, Sensor};
//!
//! let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
//! let position = time.iter().map(|t| 0.1 * (6.0 * t).sin()).collect();
//! let input = time.iter().map(|t| 0.01 * (6.0 * t).cos()).collect();
//!
//! let mut recording = Recording::new("A paddle", 0.25, Model::new(5.755e-4));
//! recording.sensors.insert("position".into(), Sensor { noise: 1e-4, ..Sensor::default() });
//! recording.runs.push(Run::new("sine.csv", Drive::OpenLoop, time, input, position));
//!
//! let folder = std::env::temp_dir().join(format!("recording-example-{}", std::process::id()));
//! recording.write(&folder)?;
//! assert_eq!(Recording::read(&folder)?.runs, recording.runs);
//! # std::fs::remove_dir_all(&folder).unwrap();
//! # Ok::<(), recording::Error>(())
//! ```

mod actuator;
mod checks;
mod columns;
mod digits;
mod error;
mod keys;
mod manifest;
mod model;
mod oddity;
mod read;
mod run;
mod sensor;
mod statistics;
mod text;
mod units;
mod validate;
mod write;

pub use actuator::{Actuator, Motor, NoRatio, Servo};
pub use error::{Error, Fault};
pub use model::{Model, NoModel, Tolerance};
pub use oddity::Oddity;
pub use run::{Drive, InputSampling, Pid, Run};
pub use sensor::{Sensor, low_pass_gain};
pub use statistics::sixth_differences;
pub use text::{open_file, plain_message, read_text};
pub use units::Units;

use std::collections::BTreeMap;
use std::path::PathBuf;

/// A recording: the nominal model, the sensors, and the runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The folder that it was read from. Empty for a recording made in memory.
    pub folder: PathBuf,
    /// A title, for display.
    pub title: String,
    /// Length of a prediction window, s.
    pub horizon: f64,
    /// Half width of the interval over which a restart state is fitted, s.
    pub restart_half_width: f64,
    /// Units of position and input. They are mainly for display.
    pub units: Units,
    /// The nominal model of joint and actuator together.
    pub model: Model,
    /// The actuator, if the manifest describes it by a data sheet or as a servo.
    pub actuator: Option<Actuator>,
    /// Tolerances of the model's numbers.
    pub tolerance: Tolerance,
    /// Numbers of [`Model::ESSENTIAL`] that the recording does not state. `model` holds assumed values for them.
    pub unstated: Vec<&'static str>,
    /// Sensors by the names of their columns. After reading, `position` always has one.
    pub sensors: BTreeMap<String, Sensor>,
    /// The runs, in the order of the manifest.
    pub runs: Vec<Run>,
    /// Minor problems of the recording and how they were handled.
    pub oddities: Vec<Oddity>,
}

impl Recording {
    /// Default of [`restart_half_width`](Self::restart_half_width), s.
    pub const RESTART_HALF_WIDTH: f64 = 0.008;

    /// A recording without runs and with an ideal position sensor. `horizon` is in s.
    pub fn new(title: impl Into<String>, horizon: f64, model: Model) -> Self {
        Self {
            folder: PathBuf::new(),
            title: title.into(),
            horizon,
            restart_half_width: Self::RESTART_HALF_WIDTH,
            units: Units::default(),
            model,
            actuator: None,
            tolerance: Tolerance::default(),
            unstated: Vec::new(),
            sensors: BTreeMap::from([("position".to_owned(), Sensor::default())]),
            runs: Vec::new(),
            oddities: Vec::new(),
        }
    }

    /// The same recording with other runs. The present runs are not copied, because they may be long.
    #[must_use]
    pub fn with_runs(&self, runs: Vec<Run>) -> Self {
        Self {
            folder: self.folder.clone(),
            title: self.title.clone(),
            units: self.units.clone(),
            model: self.model,
            tolerance: self.tolerance.clone(),
            unstated: self.unstated.clone(),
            sensors: self.sensors.clone(),
            oddities: self.oddities.clone(),
            runs,
            ..*self
        }
    }

    /// The oddities as lines of text. Equal oddities of several runs share a line.
    pub fn warnings(&self) -> Vec<String> {
        oddity::lines(&self.oddities)
    }

    /// The nominal model of `run`, including the run's own numbers.
    pub fn model_of(&self, run: &Run) -> Model {
        let mut model = self.model;
        for (name, value) in &run.numbers {
            // Reading and `validate` refuse unknown names.
            let _ = model.state(name, *value);
        }
        model
    }

    /// The sensor of `column`. An ideal one if nothing is stated.
    pub fn sensor(&self, column: &str) -> Sensor {
        self.sensors.get(column).copied().unwrap_or_default()
    }
}
