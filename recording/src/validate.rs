//! Checks that every recording must pass.

use crate::checks::plausible;
use crate::error::{Error, Fault};
use crate::keys::{self, Lines};
use crate::manifest::{self, Controller, Parsed};
use crate::model::{FINITE, NOT_NEGATIVE, POSITIVE};
use crate::{Actuator, Model, Recording, Run};
use std::path::{Component, Path};

/// Relative rounding error of printed and summed times.
const ROUNDING: f64 = 1e-6;

impl Recording {
    /// Checks that this recording can be read back after it is written.
    ///
    /// # Errors
    ///
    /// The same as for [`Recording::read`], without the folder.
    pub fn validate(&self) -> Result<(), Error> {
        let lines = self.validate_manifest()?;
        for recorded in &self.runs {
            run(recorded, self).map_err(|error| error.in_file(recorded.file.as_ref()))?;
        }
        sensors(self, &lines).map_err(|error| error.in_file(manifest::FILE.as_ref()))
    }

    /// Checks the manifest alone. Returns the lines of its keys.
    pub(crate) fn validate_manifest(&self) -> Result<Lines, Error> {
        let failed = |error: Error| error.in_file(manifest::FILE.as_ref());
        let text = manifest::text(self)
            .map_err(|source| failed(Error::new(Fault::Unwritable { source })))?;
        let parsed = manifest::parse(&text).map_err(failed)?;
        self::manifest(&parsed).map_err(failed)?;
        Ok(parsed.lines)
    }
}

/// Checks that all numbers are in their possible ranges.
pub(crate) fn manifest(parsed: &Parsed) -> Result<(), Error> {
    let Parsed {
        manifest,
        actuator,
        tolerance,
        lines,
        ..
    } = parsed;
    let check = |key: &str, value: f64, holds: bool, wanted: &'static str| {
        let wanted = if value.is_finite() { wanted } else { FINITE };
        if holds && value.is_finite() {
            return Ok(());
        }
        let fault = Fault::OutOfRange {
            key: key.to_owned(),
            value: value.to_string(),
            wanted,
        };
        Err(Error::new(fault).at(lines.get(key)))
    };
    let positive = |key: &str, value: f64| check(key, value, value > 0.0, POSITIVE);
    let not_negative = |key: &str, value: f64| check(key, value, value >= 0.0, NOT_NEGATIVE);

    positive("horizon", manifest.horizon)?;
    positive("restart_half_width", manifest.restart_half_width)?;

    let check_model = |table: &str, model: &Model| {
        model.check().map_err(|wrong| {
            let key = format!("{table}.{}", wrong.name);
            let line = lines.get(&key);
            let fault = Fault::OutOfRange {
                key,
                value: wrong.value,
                wanted: wrong.wanted,
            };
            Error::new(fault).at(line)
        })
    };
    for (key, value, holds, wanted) in actuator.iter().flat_map(Actuator::judged) {
        check(&key, value, holds, wanted)?;
    }
    check_model("model", &manifest.model)?;
    for (name, relative) in tolerance.iter() {
        not_negative(&format!("model.tolerance.{name}"), relative)?;
    }
    for (name, sensor) in &manifest.sensor {
        not_negative(&format!("sensor.{name}.resolution"), sensor.resolution)?;
        not_negative(&format!("sensor.{name}.noise"), sensor.noise)?;
        if let Some(cutoff_hz) = sensor.cutoff_hz {
            positive(&format!("sensor.{name}.cutoff_hz"), cutoff_hz)?;
        }
    }
    if manifest.runs.is_empty() {
        return Err(Error::new(Fault::NoRuns));
    }
    for (k, run) in manifest.runs.iter().enumerate() {
        if !is_inside(&run.file) {
            let line = lines.get(&format!("runs.{k}.file"));
            return Err(Error::new(Fault::Outside {
                file: run.file.clone(),
            })
            .at(line));
        }
        if manifest.runs[..k]
            .iter()
            .any(|other| other.file == run.file)
        {
            let file = run.file.clone();
            let line = lines.get(&format!("runs.{k}.file"));
            return Err(Error::new(Fault::SameFile { file }).at(line));
        }
        not_negative(&format!("runs.{k}.input_time_std"), run.input_time_std)?;
        let mut own = manifest.model;
        for (name, value) in &run.model {
            let _ = own.state(name, *value);
        }
        check_model(&format!("runs.{k}.model"), &own)?;
        if let Some(Controller::Pid(pid)) = &run.controller {
            let key = |name: &str| format!("runs.{k}.controller.{name}");
            for (name, gain) in [("kp", pid.kp), ("ki", pid.ki), ("kd", pid.kd)] {
                check(&key(name), gain, true, FINITE)?;
            }
            positive(&key("period"), pid.period)?;
            if let Some(cutoff_hz) = pid.position_cutoff_hz {
                positive(&key("position_cutoff_hz"), cutoff_hz)?;
            }
        }
    }
    Ok(())
}

/// Checks that the samples of a run can be used.
pub(crate) fn run(run: &Run, recording: &Recording) -> Result<(), Error> {
    let (duration_s, horizon) = (run.duration_s(), recording.horizon);
    // The last sample also lasts one period: 500 samples at 1 kHz are 0.5 s.
    let samples = run.len() as f64;
    if samples < 2.0 || duration_s * samples / (samples - 1.0) < horizon * (1.0 - ROUNDING) {
        return Err(Error::new(Fault::TooShort {
            duration_s,
            horizon,
        }));
    }
    let first = run.position.first().copied().unwrap_or_default();
    if run.position.iter().all(|value| *value == first) {
        return Err(Error::new(Fault::Frozen { value: first }));
    }
    plausible::run(run, recording)
}

/// Checks that every sensor table has a column.
pub(crate) fn sensors(recording: &Recording, lines: &Lines) -> Result<(), Error> {
    for name in recording.sensors.keys() {
        if !position_columns(recording).any(|column| column == name) {
            let free = position_columns(recording)
                .filter(|column| !recording.sensors.contains_key(*column));
            let nearest = keys::nearest(name, free).map(str::to_owned);
            let fault = Fault::SensorWithoutColumn {
                name: name.clone(),
                nearest,
            };
            return Err(Error::new(fault).at(lines.get(&format!("sensor.{name}"))));
        }
    }
    Ok(())
}

/// The position columns of all runs. A name can occur several times.
pub(crate) fn position_columns(recording: &Recording) -> impl Iterator<Item = &str> {
    let further = recording
        .runs
        .iter()
        .flat_map(|run| run.positions.keys())
        .map(String::as_str);
    std::iter::once("position").chain(further)
}

/// Returns true if `file` is inside the folder that it is joined to.
pub(crate) fn is_inside(file: &str) -> bool {
    let path = Path::new(file);
    !file.is_empty()
        && path
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
