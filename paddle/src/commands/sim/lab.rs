//! `paddle sim lab`: simulates the lab's own Simulink model, in which the dry friction has no effect.

use super::experiment::leave_recording;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::{self, Folder};
use crate::numbers;
use crate::plot::{Figure, Ink, Line, Panel};
use crate::targets::{Target, Use};
use clap::Args;
use host_sim::experiment::ExperimentError;
use host_sim::lab_model::{FRICTION_FROM_RAD_S, LabDrive, LabModel, LabSample};
use host_sim::presets;
use recording::{Drive, Recording, Run};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  paddle sim lab --amplitude 0.0011 --recording lab-2018
  paddle gap diagnose lab-2018

The model of the report's figures 1 to 4, with the two slips of its dry friction: the torque passes in every second step
of 10 ms while it is above 1 mN m, and not at all below, and friction acts above 20 rad/s alone. The recording has the
torque that the model let through, its motor_torque scope, as input, and the lab's numbers with 1 mN m of dry friction
as the nominal model.")]
pub struct Arguments {
    /// Amplitude of the torque sine, N m at the motor.
    #[arg(long, default_value_t = 0.0011, value_name = "N m", value_parser = numbers::finite)]
    amplitude: f64,
    /// Frequency of the torque sine.
    #[arg(long, default_value_t = 1.0, value_name = "Hz", value_parser = numbers::positive)]
    frequency: f64,
    /// Duration of the simulation.
    #[arg(long, default_value_t = 20.0, value_name = "s", value_parser = numbers::positive)]
    seconds: f64,
    /// Write the plot and the CSV to this folder.
    #[arg(long, default_value = "paddle-out", value_name = "DIR")]
    out: PathBuf,
    /// Write a recording to this folder, for `paddle gap`.
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
}

/// Longest simulation, s.
const LONGEST_S: f64 = 3600.0;

/// Runs the simulation.
///
/// # Errors
/// Returns a [`Failure`] if a number is invalid, or if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let &Arguments {
        amplitude,
        frequency,
        seconds,
        ..
    } = arguments;
    if seconds > LONGEST_S {
        return Err(ExperimentError::Duration(seconds).into());
    }
    if arguments.recording.is_some() && seconds < HORIZON_S {
        return Err(Failure::Setting(format!(
            "--seconds {seconds}: the recording has prediction windows of {HORIZON_S} s; record for longer"
        )));
    }
    let drive = LabDrive::Sine {
        amplitude_nm: amplitude,
        frequency_hz: frequency,
    };
    let samples = LabModel::at_rest(presets::nominal(), drive).run(seconds);
    let column = |of: fn(&LabSample) -> f64| samples.iter().map(of).collect::<Vec<f64>>();
    let time = column(|s| s.time_s);
    let position_deg = column(|s| s.position_rad.to_degrees());
    let motor_nm = column(|s| s.motor_nm);
    let lowest = position_deg.iter().copied().fold(0.0, f64::min);
    let highest = position_deg.iter().copied().fold(0.0, f64::max);
    let fastest = column(|s| s.velocity_rad_s.abs())
        .into_iter()
        .fold(0.0, f64::max);
    let acts = fastest > FRICTION_FROM_RAD_S;

    let title = format!(
        "The lab's Simulink model: torque sine of {} mN m, {frequency} Hz",
        files::logged(1e3 * amplitude)
    );
    let scaled: Vec<_> = motor_nm.iter().map(|nm| 1e3 * nm).collect();
    let panel = |y_label: &str, ink, y: &[f64]| Panel {
        y_label: y_label.into(),
        lines: vec![Line::new(y_label, ink, &time, y)],
        ..Panel::default()
    };
    let figure = Figure {
        title: title.clone(),
        x_label: "time, s".into(),
        panels: vec![
            panel("position, degrees", Ink::Model, &position_deg),
            panel("torque that it let through, mN m", Ink::Other(0), &scaled),
        ],
        ..Figure::default()
    };
    let mut folder = Folder::new(&arguments.out);
    folder.draw("lab.svg", figure.svg());
    folder.put(
        "lab.csv",
        &files::csv(&[
            ("time_s", &time),
            ("command_nm", &column(|s| s.command_nm)),
            ("motor_nm", &motor_nm),
            ("position_deg", &position_deg),
            ("velocity_deg_s", &column(|s| s.velocity_rad_s.to_degrees())),
        ]),
    );
    let mut text = format!(
        "{title}\n  position      {lowest:>8.2} to {highest:.2}°\n  fastest       {:>8.0}°/s; its dry friction acts above {:.0}°/s: {}\n",
        fastest.to_degrees(),
        FRICTION_FROM_RAD_S.to_degrees(),
        if acts { "at times" } else { "never" }
    );
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    let files = json!(folder.files());
    let mut problems = folder.lost();
    if let Some(path) = &arguments.recording {
        match leave_recording(path, &recorded(&samples)) {
            Ok(()) => drop(writeln!(text, "  recording in {}", path.display())),
            Err(failure) => problems.push(failure),
        }
    }
    Ok(Answer {
        text,
        json: json!({
            "experiment": "lab",
            "title": title,
            "position_deg": [lowest, highest],
            "fastest_deg_s": fastest.to_degrees(),
            "friction_acts": acts,
            "amplitude_nm": amplitude,
            "frequency_hz": frequency,
            "seconds": seconds,
            "files": files,
            "recording": arguments.recording,
        }),
        problems,
    })
}

/// Prediction window of the recording, s.
const HORIZON_S: f64 = 0.5;

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let out = Target::of("--out", Use::NewFolder, &self.out);
        let recording = Target::of("--recording", Use::NewFolder, self.recording.as_ref());
        [out, recording].into_iter().flatten().collect()
    }
}

fn recorded(samples: &[LabSample]) -> Recording {
    let column = |of: fn(&LabSample) -> f64| -> Vec<f64> {
        samples.iter().map(|s| files::logged(of(s))).collect()
    };
    let mut recording = Recording::new("The lab's Simulink model", HORIZON_S, presets::nominal());
    recording.runs.push(Run::new(
        "lab.csv",
        Drive::OpenLoop,
        column(|s| s.time_s),
        column(|s| s.motor_nm),
        column(|s| s.position_rad),
    ));
    recording
}
