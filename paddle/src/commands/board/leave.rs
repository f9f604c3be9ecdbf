//! What a run of the board leaves: a trace of what the firmware saw, a recording of what the paddle did.

use crate::failure::Failure;
use crate::files::{self, Folder, csv};
use host_sim::closed_loop::LoopSetup;
use host_sim::experiment;
use recording::{Drive, Model, Run, Sensor};
use std::path::Path;
use virtual_board::board::Step;
use virtual_board::wiring::STEP_S;

/// Steps of the paddle in a row at so many rows a second.
///
/// # Errors
/// [`Failure::Board`] for a rate that is none.
pub fn steps_per_row(log_hz: f64) -> Result<usize, Failure> {
    if log_hz > 0.0 {
        Ok((1.0 / (log_hz * STEP_S)).round().max(1.0) as usize)
    } else {
        Err(Failure::Board(format!(
            "--log-rate {log_hz}: give more than 0 rows a second"
        )))
    }
}

/// What the firmware saw and did, as CSV: one row for the last of each so many control periods.
pub fn trace(steps: &[Step], steps_per_row: usize) -> String {
    let column = |value: fn(&Step) -> f64| -> Vec<f64> {
        let last = steps.iter().skip(steps_per_row - 1);
        last.step_by(steps_per_row).map(value).collect()
    };
    csv(&[
        ("time", &column(|step| step.time_s)),
        (
            "encoder",
            &column(|step| f64::from(step.encoder_count as i32)),
        ),
        ("hall", &column(|step| f64::from(step.hall_counts))),
        (
            "current",
            &column(|step| {
                f64::from(step.current.sum) / f64::from(step.current.conversions.max(1))
            }),
        ),
        ("compare", &column(|step| f64::from(step.compare))),
        (
            "on",
            &column(|step| f64::from(u8::from(step.duty.is_some()))),
        ),
        ("duty", &column(|step| step.duty.unwrap_or(0.0))),
    ])
}

/// Leaves a recording: true position against the torque that the motor really made.
///
/// # Errors
/// [`Failure`] for a folder that cannot be used.
pub fn recording(
    path: &Path,
    steps: &[Step],
    steps_per_row: usize,
    horizon: f64,
    model: Model,
    setup: &LoopSetup,
) -> Result<(), Failure> {
    let mut run = Run::new("board.csv", Drive::ClosedLoop, vec![], vec![], vec![]);
    let mut currents = Vec::new();
    // A row's input is what acts until the next, which the following steps tell.
    let mut rows = steps.chunks_exact(steps_per_row);
    let mut before = rows.next().and_then(<[Step]>::last);
    for row in rows {
        let Some(at) = before else { break };
        let torque_nm = row.iter().map(|step| step.torque_nm).sum::<f64>() / row.len() as f64;
        run.time.push(files::logged(at.time_s));
        run.position.push(files::logged(at.position_rad));
        run.input.push(files::logged(torque_nm));
        currents
            .push((at.torque_nm / f64::from(setup.settings.motor.torque_constant_nm_per_a)) as f32);
        before = row.last();
    }
    run.current = Some(currents);
    let mut recording = experiment::recording("The virtual board", horizon, model, setup);
    recording.sensors.clear();
    recording
        .sensors
        .insert("position".into(), Sensor::default());
    recording.runs.push(run);
    let folder = Folder::make_beside_recordings(path)?;
    Ok(recording.write(folder.path())?)
}
