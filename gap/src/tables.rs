//! A table of the missing torque in addition to a corrected model, evaluated on held-out parts of the recording.

use crate::diagnose::CorrectedModel;
use crate::measure::measure;
use crate::missing_torque::MissingTorque;
use crate::missing_torque::table::Table;
use crate::windows::restart;
use recording::{Recording, Run};

/// Number of parts into which each run is divided. Every second part is held out.
const STRETCHES: usize = 6;
/// Least share of the residual of the model that a table must close on held-out data.
const LEAST_SHRINK: f64 = 0.05;

/// The result of a trial with a table.
#[derive(Clone, Debug)]
pub enum Tabulated {
    /// A table predicts held-out data better than the model without it.
    Closes {
        /// The table, fitted to the whole recording.
        table: Table,
        /// Share of the residual of the model on held-out data that a table closes, from 0 to 1.
        shrink: f64,
    },
    /// The motion is only periodic, so that a table would memorize it.
    Repeats,
    /// No function of velocity, position or input predicts the missing torque on held-out data.
    ClosesNothing,
}

/// Tries a table of the torque that a corrected model still lacks, over the axis that explains most of it.
pub fn tabulated(recording: &Recording, model: &CorrectedModel) -> Tabulated {
    let missing = MissingTorque::of(recording, &model.device());
    if missing.summary().repeats {
        return Tabulated::Repeats;
    }
    let halves = [0, 1].map(|half| half_of(recording, half));
    let mut squares = [0.0; 2];
    for (train, test) in [(0, 1), (1, 0)] {
        let half = MissingTorque::of(&halves[train], &model.device());
        let Some(table) = half.table() else {
            return Tabulated::ClosesNothing;
        };
        let models = [model.clone(), with_table(model, table)];
        let gaps = models.map(|model| measure(&halves[test], &model.device()).0.before);
        if gaps[1] >= gaps[0] {
            return Tabulated::ClosesNothing;
        }
        squares = [0, 1].map(|i| squares[i] + gaps[i].powi(2));
    }
    let shrink = 1.0 - (squares[1] / squares[0]).sqrt();
    match missing.table() {
        Some(table) if shrink >= LEAST_SHRINK => Tabulated::Closes { table, shrink },
        _ => Tabulated::ClosesNothing,
    }
}

fn with_table(model: &CorrectedModel, table: Table) -> CorrectedModel {
    let mut model = model.clone();
    model.tables.push(table);
    model
}

/// Every second part of each run.
fn half_of(recording: &Recording, half: usize) -> Recording {
    let stretches = recording.runs.iter().flat_map(|run| {
        let edge = move |k: usize| k * run.len() / STRETCHES;
        let own = (0..STRETCHES).filter(move |k| k % 2 == half);
        own.map(move |k| run.part(edge(k)..edge(k + 1)))
    });
    let whole = |run: &Run| run.len() >= restart::FEWEST && run.duration_s() >= recording.horizon;
    let runs: Vec<Run> = stretches.filter(whole).collect();
    recording.with_runs(runs)
}
