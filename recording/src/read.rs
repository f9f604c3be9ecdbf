//! Reads a [`Recording`] from a folder.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use crate::checks::{invalid_rows, odd, repeated_rows};
use crate::columns;
use crate::error::Error;
use crate::manifest::{self, Controller, Parsed, RunEntry};
use crate::text;
use crate::validate;
use crate::{Model, Oddity, Recording, Run};

impl Recording {
    /// Reads and validates the recording in `folder`.
    ///
    /// # Errors
    ///
    /// The first fault, see [`Fault`].
    pub fn read(folder: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_watched(folder, &|_| {})
    }

    /// Reads and validates the recording in `folder`. Calls `watch` repeatedly with the share of the CSV bytes read so far.
    ///
    /// # Errors
    ///
    /// The same as for [`read`](Self::read).
    pub fn read_watched(folder: impl AsRef<Path>, watch: &dyn Fn(f64)) -> Result<Self, Error> {
        let folder = folder.as_ref();
        let path = folder.join(manifest::FILE);
        let mend = "give a folder with a `recording.toml` in UTF-8";
        let text = text::read_text(&path, mend)?;
        let parsed = manifest::parse(&text).map_err(|error| error.in_file(&path))?;
        validate::manifest(&parsed).map_err(|error| error.in_file(&path))?;
        let Parsed {
            manifest,
            actuator,
            tolerance,
            unstated,
            lines,
            oddities,
        } = parsed;

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
            actuator,
            tolerance,
            unstated,
            sensors: manifest.sensor,
            runs: Vec::with_capacity(manifest.runs.len()),
            oddities,
        };
        let sizes = manifest.runs.iter().map(|entry| {
            let file = folder.join(&entry.file).metadata();
            file.map_or(0, |file| file.len())
        });
        let sizes: Vec<u64> = sizes.collect();
        let all: u64 = sizes.iter().sum();
        let mut before = 0;
        for (entry, size) in manifest.runs.into_iter().zip(sizes) {
            let told = |bytes: u64| watch((before + bytes) as f64 / all.max(1) as f64);
            let (mut run, frozen) = read_run(folder, entry, &told)?;
            before += size;
            validate::run(&run, &recording)
                .map_err(|error| error.in_file(&folder.join(&run.file)))?;
            if let Some(stale) = odd::stale_start(&run) {
                recording.oddities.push(stale);
                run = run.part(1..run.len());
            }
            if let Some((repeated, fresh)) = repeated_rows::fresh_rows(&run) {
                recording.oddities.push(repeated);
                run = run.rows(&fresh);
            }
            let stated = recording.sensor("position");
            recording.oddities.extend(odd::run(&run, &stated, &frozen));
            recording.runs.push(run);
        }
        let invalid = invalid_rows::leave_out(&mut recording.runs);
        if !invalid.is_empty() {
            recording.oddities.extend(invalid);
            for run in &recording.runs {
                validate::run(run, &recording)
                    .map_err(|error| error.in_file(&folder.join(&run.file)))?;
            }
        }
        validate::sensors(&recording, &lines).map_err(|error| error.in_file(&path))?;
        recording.oddities.extend(recording.units.oddities());
        recording.oddities.extend(odd::session(&recording.runs));
        recording.assume_sensors();
        Ok(recording)
    }

    /// Adds an ideal sensor for every position column without one.
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

fn read_run(
    folder: &Path,
    entry: RunEntry,
    told: &dyn Fn(u64),
) -> Result<(Run, Vec<String>), Error> {
    let path = folder.join(&entry.file);
    let mend = "put the CSV there or correct `file` in recording.toml";
    let file = text::open_file(&path, mend)?;
    let watched = Watched {
        file,
        bytes: 0,
        told,
    };
    let columns = columns::read(watched).map_err(|error| error.in_file(&path))?;
    let run = Run {
        file: entry.file,
        drive: entry.drive,
        input_time_std: entry.input_time_std,
        input_sampling: entry.input_sampling,
        numbers: entry.model,
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

/// A file that reports how much of it has been read.
struct Watched<'a> {
    file: File,
    bytes: u64,
    told: &'a dyn Fn(u64),
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.bytes += count as u64;
        (self.told)(self.bytes);
        Ok(count)
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes = self.file.seek(to)?;
        Ok(self.bytes)
    }
}
