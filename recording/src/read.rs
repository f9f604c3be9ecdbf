//! From a folder to a [`Recording`].

use std::path::{Component, Path};

use crate::columns;
use crate::error::Error;
use crate::inspect;
use crate::manifest::{self, Controller, Parsed, RunEntry};
use crate::repeated;
use crate::text;
use crate::untrue;
use crate::validate;
use crate::{Model, Oddity, Recording, Run};

impl Recording {
    /// Reads and validates the recording in `folder`.
    ///
    /// # Errors
    /// The first fault that was found; see [`Fault`].
    pub fn read(folder: impl AsRef<Path>) -> Result<Self, Error> {
        let folder = folder.as_ref();
        let path = folder.join(manifest::FILE);
        let mend = "give a folder with a `recording.toml` in UTF-8";
        let text = text::read_text(&path, mend)?;
        let Parsed {
            manifest,
            tolerance,
            unstated,
            lines,
            oddities,
        } = manifest::parse(&text).map_err(|error| error.in_file(&path))?;
        validate::manifest(&manifest, &tolerance, &lines).map_err(|error| error.in_file(&path))?;

        let mut recording = Self {
            folder: folder.to_owned(),
            title: manifest.title,
            horizon: manifest.horizon,
            restart_half_width: manifest.restart_half_width,
            model: Model {
                angle_rad: manifest.units.angle_rad(),
                ..manifest.model
            },
            units: manifest.units,
            tolerance,
            unstated,
            sensors: manifest.sensor,
            runs: Vec::with_capacity(manifest.runs.len()),
            oddities,
        };
        for entry in manifest.runs {
            let (mut run, frozen) = read_run(folder, entry)?;
            validate::run(&run, &recording)
                .map_err(|error| error.in_file(&folder.join(&run.file)))?;
            if let Some(stale) = inspect::stale_start(&run) {
                recording.oddities.push(stale);
                run = run.part(1..run.len());
            }
            if let Some((repeated, fresh)) = repeated::fresh_rows(&run) {
                recording.oddities.push(repeated);
                run = run.rows(&fresh);
            }
            let stated = recording.sensor("position");
            recording
                .oddities
                .extend(inspect::run(&run, &stated, &frozen));
            recording.runs.push(run);
        }
        let untrue = untrue::leave_out(&mut recording.runs);
        if !untrue.is_empty() {
            recording.oddities.extend(untrue);
            for run in &recording.runs {
                validate::run(run, &recording)
                    .map_err(|error| error.in_file(&folder.join(&run.file)))?;
            }
        }
        validate::sensors(&recording, &lines).map_err(|error| error.in_file(&path))?;
        recording.oddities.extend(recording.units.oddities());
        recording.oddities.extend(inspect::session(&recording.runs));
        recording.assume_sensors();
        Ok(recording)
    }

    /// States an ideal sensor for every position column that has none.
    fn assume_sensors(&mut self) {
        let columns: Vec<String> = validate::position_columns(self)
            .map(str::to_owned)
            .collect();
        for column in columns {
            if !self.sensors.contains_key(&column) {
                self.oddities.push(Oddity::SensorAssumed {
                    column: column.clone(),
                });
                self.sensors.insert(column, crate::Sensor::default());
            }
        }
    }
}

fn read_run(folder: &Path, entry: RunEntry) -> Result<(Run, Vec<String>), Error> {
    let path = folder.join(&entry.file);
    let mend = "put the CSV there or correct `file` in recording.toml";
    let file = text::open_file(&path, mend)?;
    let columns = columns::read(file).map_err(|error| error.in_file(&path))?;
    let run = Run {
        file: entry.file,
        drive: entry.drive,
        input_time_std: entry.input_time_std,
        controller: entry.controller.map(|Controller::Pid(pid)| pid),
        time: columns.time,
        input: columns.input,
        position: columns.position,
        setpoint: columns.setpoint,
        positions: columns.positions,
        current: columns.current,
        supply: columns.supply,
        temperature: columns.temperature,
        ignored: columns.ignored,
    };
    Ok((run, columns.frozen))
}

/// Whether `file` names something inside the folder that it is joined to.
pub(crate) fn is_inside(file: &str) -> bool {
    let path = Path::new(file);
    !file.is_empty()
        && path
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
