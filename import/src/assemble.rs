//! From logs and a recipe to a recording.

use crate::error::ImportError;
use crate::log::Log;
use crate::recipe::Recipe;
use crate::sensor;
use crate::source::Source;
use recording::{Model, Recording, Run, Sensor};
use std::collections::BTreeSet;

/// Logs as a recording.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The runs with what the logs show of the sensors; its model is not yet anyone's.
    pub recording: Recording,
    /// What was taken for what, line by line.
    pub roles: Vec<String>,
    /// Whether a role was told from names rather than by the recipe.
    pub is_guessed: bool,
    /// What was left out, worked around, or is odd.
    pub notes: Vec<String>,
    /// Whether the position is the integral of a velocity.
    pub is_integrated: bool,
    /// One of the position's logged unit, in the recording's.
    pub(crate) position_si: f64,
    /// Whether the position was in counts.
    pub(crate) counts: bool,
}

/// Makes a recording of `logs`.
///
/// # Errors
/// [`ImportError`] where a role cannot be told, a column is not there or of another kind, and where no run is left.
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
        Source::of(log, recipe, place)?.add_to(&mut imported)?;
    }
    imported.notes = merged(imported.notes);
    let (si, counts) = (imported.position_si.abs(), imported.counts);
    let recording = &mut imported.recording;
    recording.sensors.clear();
    let shown = |column: &dyn Fn(&Run) -> Option<&Vec<f64>>| {
        let sensors = recording
            .runs
            .iter()
            .filter_map(column)
            .map(|column| sensor::shown(column));
        // A run that shows a quantum shows it for all.
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
    let mut sensors = vec![("position".to_owned(), shown(&|run| Some(&run.position)))];
    let names: BTreeSet<&String> = recording
        .runs
        .iter()
        .flat_map(|run| run.positions.keys())
        .collect();
    sensors.extend(
        names
            .into_iter()
            .map(|name| (name.clone(), shown(&|run| run.positions.get(name)))),
    );
    recording.sensors = sensors
        .into_iter()
        .filter_map(|(name, sensor)| Some((name, sensor?)))
        .collect();
    if let Some(sensor) = recording.sensors.get_mut("position") {
        match (recipe.resolution, recipe.noise) {
            // A counter has a count for a quantum, whatever the readings show.
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

/// Notes with those that several logs share said once.
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

/// Windows in one swing of the position.
const WINDOWS_PER_SWING: f64 = 3.0;
/// Rows in a window at least, and windows in a run at least.
const LEAST_IN_WINDOW: f64 = 25.0;
/// See [`LEAST_IN_WINDOW`].
const LEAST_WINDOWS: f64 = 6.0;

/// A horizon over which a model's errors show: a part of a swing, in which there are enough rows, often enough in a run.
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
