//! Makes a recording from logs and a recipe.

use crate::counter;
use crate::error::ImportError;
use crate::log::Log;
use crate::recipe::Recipe;
use crate::runs::{Span, spans};
use crate::sensor;
use crate::signal::Choice;
use crate::source::{Source, shown};
use crate::stretch::{Columns, LEAST_ROWS, Stretch};
use recording::{Model, Recording, Run, Sensor, Units};
use std::collections::BTreeSet;

/// The result of an import.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The runs, and the sensor properties that the logs show. The model is only a placeholder.
    pub recording: Recording,
    /// The columns used for each role, one line each.
    pub roles: Vec<String>,
    /// True if a role was guessed from names instead of given by the recipe.
    pub is_guessed: bool,
    /// What was left out, corrected, or looks unusual.
    pub notes: Vec<String>,
    /// True if the position was integrated from a velocity.
    pub is_integrated: bool,
    /// One unit of the logged position, in units of the recording.
    pub(crate) position_si: f64,
    /// True if the logged position was in counts.
    pub(crate) counts: bool,
}

/// Makes a recording from `logs`.
///
/// # Errors
///
/// [`ImportError`] if a role cannot be guessed, a column is missing or has the wrong type, or no run remains.
pub fn import(logs: &[Log], recipe: &Recipe) -> Result<Imported, ImportError> {
    let title = recipe.title.clone().unwrap_or_else(|| {
        logs.iter()
            .map(|log| log.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    });
    let mut imported = Imported {
        recording: Recording::new(title, 1.0, Model::new(1.0)),
        roles: Vec::new(),
        is_guessed: false,
        notes: Vec::new(),
        is_integrated: false,
        position_si: 1.0,
        counts: false,
    };
    for (place, log) in logs.iter().enumerate() {
        add(Source::of(log, recipe, place)?, &mut imported)?;
    }
    imported.notes = merged(imported.notes);
    let (si, counts) = (imported.position_si.abs(), imported.counts);
    let recording = &mut imported.recording;
    recording.sensors.clear();
    let sensor_of = |column: &dyn Fn(&Run) -> Option<&Vec<f64>>| {
        let sensors = recording
            .runs
            .iter()
            .filter_map(column)
            .map(|column| sensor::shown(column));
        // A quantum found in one run applies to all.
        sensors.reduce(|one, other| Sensor {
            resolution: one.resolution.max(other.resolution),
            noise: if one.resolution.max(other.resolution) > 0.0 {
                0.0
            } else {
                one.noise.max(other.noise)
            },
            cutoff_hz: None,
        })
    };
    let mut sensors = vec![("position".to_owned(), sensor_of(&|run| Some(&run.position)))];
    let names: BTreeSet<&String> = recording
        .runs
        .iter()
        .flat_map(|run| run.positions.keys())
        .collect();
    sensors.extend(
        names
            .into_iter()
            .map(|name| (name.clone(), sensor_of(&|run| run.positions.get(name)))),
    );
    recording.sensors = sensors
        .into_iter()
        .filter_map(|(name, sensor)| Some((name, sensor?)))
        .collect();
    if let Some(sensor) = recording.sensors.get_mut("position") {
        match (recipe.resolution, recipe.noise) {
            // The quantum of a counter is one count, whatever the readings show.
            (None, None) if counts && recipe.undo_low_pass_hz.is_none() => {
                *sensor = Sensor {
                    resolution: si,
                    ..Sensor::default()
                };
            }
            (None, None) => {}
            (resolution, noise) => {
                sensor.resolution = resolution.unwrap_or(0.0) * si;
                sensor.noise = noise.unwrap_or(0.0) * si;
            }
        }
    }
    recording.horizon = recipe
        .horizon_s
        .unwrap_or_else(|| horizon_s(&recording.runs));
    Ok(imported)
}

/// Adds the runs of a log to a recording.
fn add(mut source: Source, imported: &mut Imported) -> Result<(), ImportError> {
    let quantity = source.position_quantity()?;
    let (input_si, input_unit) = source.input_unit()?;
    let mut position = source.readings()?;
    let reading = source.wrapped(&mut position, quantity.counts);
    source
        .roles
        .push(format!("position  {}", quantity.said(&source, &reading)));
    let input = match &source.input {
        Some(choice) => {
            let mut values = choice.values(source.log)?;
            if let Some(bit) = source.recipe.input_sign_bit {
                counter::sign_magnitude(&mut values, bit);
            }
            if let Some(bits) = source.recipe.input_bits {
                counter::twos_complement(&mut values, bits);
            }
            let tick = match (choice, source.recipe.tick_s) {
                (Choice::Formula { .. }, Some(tick_s)) => {
                    format!(", mean over ticks of {} ms", 1e3 * tick_s)
                }
                _ => String::new(),
            };
            source.roles.push(format!(
                "input     `{}` in {}{tick}",
                choice.name(),
                shown(&input_unit)
            ));
            Some(values)
        }
        None => {
            source.roles.push(format!(
                "input     the PID law on the logged position, in {}",
                shown(&input_unit)
            ));
            None
        }
    };
    let setpoint = source
        .setpoint
        .as_ref()
        .map(|choice| choice.values(source.log))
        .transpose()?;
    if let Some(choice) = &source.setpoint {
        source.roles.push(format!("setpoint  `{}`", choice.name()));
    }
    let live = |values: &[f64]| {
        let mut filled = values.iter().filter(|value| !value.is_nan());
        filled
            .next()
            .is_some_and(|first| filled.any(|value| value != first))
    };
    if !live(&position) {
        return Err(ImportError::Frozen {
            log: source.log.name.clone(),
            column: source.position.name().to_owned(),
            value: position
                .iter()
                .copied()
                .find(|x| !x.is_nan())
                .unwrap_or(f64::NAN),
            live: source.log.live_names(),
        });
    }
    if let (Some(values), Some(choice)) = (&input, &source.input)
        && !live(values)
    {
        source.notes.push(format!(
            "{}: the input `{}` is the same in every row, so it says nothing about the actuator; live columns: {}",
            source.log.name, choice.name(), source.log.live_names()
        ));
    }
    let spans = spans(&source.seconds, source.split_by, source.recipe.split_gap_s);
    let several = spans.len() > 1;
    let mut too_short = 0;
    let begin_s = spans
        .first()
        .map_or(0.0, |span| source.seconds[span.rows[0]]);
    let mut any = false;
    let columns = Columns {
        position: &position,
        input: input.as_deref(),
        setpoint: setpoint.as_deref(),
    };
    for (place, span) in spans.iter().enumerate() {
        let file = file(&source, span, place, several, imported);
        let stretch = Stretch {
            source: &source,
            columns: &columns,
            quantity: &quantity,
            input_si,
            begin_s,
        };
        match stretch.run(span, file)? {
            Some(run) => {
                any = true;
                imported.recording.runs.push(run);
            }
            None => too_short += 1,
        }
    }
    if too_short > 0 {
        source.notes.push(format!(
            "{}: {too_short} stretches of fewer than {LEAST_ROWS} rows are left out",
            source.log.name
        ));
    }
    if !any {
        return Err(ImportError::NothingLeft {
            log: source.log.name.clone(),
            rows: LEAST_ROWS,
            mend: "check --time and its unit, --split-gap and --keep",
        });
    }
    imported.recording.units = Units {
        position: quantity.unit.to_owned(),
        input: input_unit,
    };
    if imported.roles.is_empty() {
        imported.roles = source.roles;
    } else if imported.roles != source.roles {
        let roles = source.roles.join("; ");
        source
            .notes
            .push(format!("{}: other columns: {roles}", source.log.name));
    }
    imported.notes.extend(source.notes);
    imported.is_guessed |= source.is_guessed;
    imported.is_integrated |= source.is_velocity;
    imported.position_si = quantity.si;
    imported.counts |= quantity.counts.is_some();
    Ok(())
}

/// A unique file name for a run.
fn file(source: &Source, span: &Span, place: usize, several: bool, imported: &Imported) -> String {
    let plain = |text: &str| -> String {
        let kept = |c: char| {
            if c.is_alphanumeric() || "-_.".contains(c) {
                c
            } else {
                '_'
            }
        };
        text.chars().map(kept).collect()
    };
    let stem = match (&span.label, several) {
        (Some(label), true) => format!("{}-{}", plain(&source.log.name), plain(label)),
        (None, true) => format!("{}-{}", plain(&source.log.name), place + 1),
        _ => plain(&source.log.name),
    };
    let stem = if stem.trim_matches(['.', '_']).is_empty() {
        "run".to_owned()
    } else {
        stem
    };
    let is_free = |file: &String| imported.recording.runs.iter().all(|run| run.file != *file);
    let mut numbered = (2..).map(|number| format!("{stem}-{number}.csv"));
    let first = format!("{stem}.csv");
    if is_free(&first) {
        first
    } else {
        numbered.find(is_free).unwrap_or(first)
    }
}

/// Combines equal notes of several logs.
fn merged(notes: Vec<String>) -> Vec<String> {
    let mut kinds: Vec<(String, String, Vec<String>)> = Vec::new();
    for note in notes {
        let (log, said) = note.split_once(": ").unwrap_or(("", &note));
        match kinds.iter_mut().find(|(_, other, _)| other == said) {
            Some((_, _, others)) => others.push(log.to_owned()),
            None => kinds.push((log.to_owned(), said.to_owned(), Vec::new())),
        }
    }
    let line = |(log, said, others): (String, String, Vec<String>)| match others.len() {
        0 if log.is_empty() => said,
        0 => format!("{log}: {said}"),
        1..=3 => format!("{log}: {said}; likewise {}", others.join(", ")),
        more => format!("{log}: {said}; likewise {more} other logs"),
    };
    kinds.into_iter().map(line).collect()
}

/// Number of windows per oscillation of the position.
const WINDOWS_PER_SWING: f64 = 3.0;
/// Fewest rows per window.
const LEAST_IN_WINDOW: f64 = 25.0;
/// Fewest windows per run.
const LEAST_WINDOWS: f64 = 6.0;

/// A horizon over which model errors become visible: a part of an oscillation with enough rows, and short enough to have
/// several in a run.
fn horizon_s(runs: &[Run]) -> f64 {
    let of_run = |run: &Run| {
        let duration_s = run.duration_s();
        let period_s = duration_s / run.len().max(2) as f64;
        let mean = run.position.iter().sum::<f64>() / run.len() as f64;
        let crossings = run
            .position
            .windows(2)
            .filter(|pair| (pair[0] < mean) != (pair[1] < mean))
            .count();
        let swing_s = 2.0 * duration_s / crossings.max(1) as f64;
        (swing_s / WINDOWS_PER_SWING)
            .clamp(0.02, 1.0)
            .max(LEAST_IN_WINDOW * period_s)
            .min(duration_s / LEAST_WINDOWS)
    };
    let mut all: Vec<f64> = runs.iter().map(of_run).collect();
    all.sort_unstable_by(f64::total_cmp);
    let middle = all.get(all.len() / 2).copied().unwrap_or(0.5);
    let shortest = runs
        .iter()
        .map(Run::duration_s)
        .fold(f64::INFINITY, f64::min);
    format!("{:.1e}", middle.min(shortest))
        .parse()
        .unwrap_or(middle)
}
