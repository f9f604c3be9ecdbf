//! A table of the missing torque on top of a corrected model, judged on held-out stretches.

use crate::diagnose::CorrectedModel;
use crate::measure::measure;
use crate::missing_torque::MissingTorque;
use crate::missing_torque::table::Table;
use crate::windows::restart;
use recording::{Recording, Run};

/// Stretches into which each run is cut: every other one is held out.
const STRETCHES: usize = 6;
/// Share of what the model leaves that a table must close on held-out data.
const LEAST_SHRINK: f64 = 0.05;

/// The outcome of a trial with a table.
#[derive(Clone, Debug)]
pub enum Tabulated {
    /// A table predicts held-out stretches better than the model without it.
    Closes {
        /// The table, made from all of the recording.
        table: Table,
        /// Share that a table closes of what the model leaves of held-out stretches, 1 = all.
        shrink: f64,
    },
    /// The motion only repeats itself, so that a table would remember it.
    Repeats,
    /// What is missing is no function of velocity, position or input that predicts held-out data.
    ClosesNothing,
}

/// Tries a table of what a corrected model still lacks, over the axis that carries it best.
pub fn tabulated(recording: &Recording, model: &CorrectedModel) -> Tabulated {
    let missing = MissingTorque::of(recording, &model.device());
    if missing.summary().repeats {
        return Tabulated::Repeats;
    }
    let halves = [0, 1].map(|half| half_of(recording, half));
    let mut left = [0.0; 2];
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
        left = [0, 1].map(|i| left[i] + gaps[i].powi(2));
    }
    let shrink = 1.0 - (left[1] / left[0]).sqrt();
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

/// Every other stretch of each run.
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
