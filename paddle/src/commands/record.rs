//! `paddle record`: records experiments on a board.

use crate::answer::Answer;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::numbers;
use crate::plant_choice::PlantChoice;
use crate::progress;
use crate::rig::{ROWS_HZ, Rig};
use crate::targets::{Target, Use};
use clap::Args;
use haptic_paddle::settings::Settings;
use recording::Tolerance;
use remote::{Plan, Recorder, Session, Wire};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle record --port /dev/ttyUSB0 --run step:10 --run multisine:0.0036,2,4 --out my-recording
  paddle gap diagnose my-recording

An experiment is SHAPE:AMPLITUDE,HZ,SECONDS of a shape of the console's `start`. A step is of the position, in degrees, and
is recorded on its way back, too; all others are of the torque, in N m at the motor. `position:` or `torque:` in front
says otherwise. Before each the paddle is brought to the middle.

Ctrl-C disarms the paddle, and keeps the runs that are complete. If this program or the line dies, the board disarms by
itself after host.heartbeat. The paddle must be free to move, and hang as it always does.")]
pub struct Arguments {
    /// Serial port of the board, or the terminal that `paddle board` prints.
    #[arg(long)]
    port: String,
    /// Experiment to run; may be repeated.
    #[arg(long = "run", required = true, value_name = "SHAPE:NUMBERS")]
    runs: Vec<Plan>,
    /// Write the recording to this folder.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    nominal: Nominal,
    /// Rows per second.
    #[arg(long, default_value_t = ROWS_HZ, value_name = "Hz", value_parser = numbers::positive)]
    rate: f64,
}

const HORIZON_S: f64 = 0.3;
const TITLE: &str = "A paddle";

/// Data that a recording states in addition to its runs.
#[derive(Args)]
pub struct Nominal {
    /// Nominal model, whose gap is to be measured: `nominal`, `refit`, or a TOML file with the changes from nominal.
    #[arg(long, default_value = "nominal", value_name = "nominal|FILE.toml")]
    model: PlantChoice,
    /// Prediction window that the recording states.
    #[arg(long, default_value_t = HORIZON_S, value_name = "s", value_parser = numbers::positive)]
    horizon: f64,
    /// Title of the recording.
    #[arg(long, default_value = TITLE, value_name = "TEXT")]
    title: String,
}

impl Default for Nominal {
    fn default() -> Self {
        Self {
            model: PlantChoice::Nominal,
            horizon: HORIZON_S,
            title: TITLE.into(),
        }
    }
}

/// Relative standard deviations of the nominal model's numbers, as the lab states them for its paddle.
const TOLERANCE: [(&str, f64); 4] = [
    ("inertia", 0.02),
    ("gravity", 0.05),
    ("viscous", 0.2),
    ("coulomb", 0.2),
];

impl Nominal {
    /// The file that the option names.
    pub fn target(&self) -> Option<Target<'_>> {
        Target::of("--model", Use::Read, self.model.file())
    }

    /// Creates a recording without runs for a board with these settings.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the model file cannot be used.
    pub fn recorder(&self, settings: &Settings) -> Result<Recorder, Failure> {
        let mut tolerance = Tolerance::default();
        for (name, relative) in TOLERANCE {
            tolerance.set(name, relative);
        }
        Ok(Recorder::new(Session {
            title: self.title.clone(),
            horizon_s: self.horizon,
            model: self.model.load()?.model,
            tolerance,
            settings: *settings,
        }))
    }
}

/// Records the experiments.
///
/// # Errors
/// Returns a [`Failure`] if the board refuses a command, and if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let interrupt = Interrupt::watched()?;
    let mut rig = Rig::open(&arguments.port)?;
    let mut recorder = arguments.nominal.recorder(&rig.settings)?;
    let mut problems = Vec::new();
    for (at, plan) in arguments.runs.iter().enumerate() {
        progress::within(&format!("run {} of {}", at + 1, arguments.runs.len()));
        match rig.take(plan, arguments.rate, &interrupt) {
            Ok(taken) => {
                if let Some(fault) = &taken.fault {
                    problems.push(Failure::Device(remote::DeviceError::Fault(format!(
                        "{fault}; {plan} is kept up to then"
                    ))));
                }
                recorder.add(&taken);
            }
            Err(error) => {
                problems.push(error.into());
                break;
            }
        }
    }
    if recorder.recording().runs.is_empty() {
        return Err(problems.pop().unwrap_or(Failure::Fault));
    }
    problems.extend(rig.leave().err().map(Failure::from));
    leave(&recorder, &rig, &arguments.out)?;

    let mut text = String::new();
    for run in &recorder.recording().runs {
        let _ = writeln!(text, "  {:<32} {:.2} s", run.file, run.duration_s());
    }
    let folder = arguments.out.display();
    let _ = writeln!(
        text,
        "recording in {folder}; next: paddle gap diagnose {folder}"
    );
    Ok(Answer {
        text,
        json: json!({
            "recording": arguments.out,
            "runs": recorder.recording().runs.iter().map(|run| json!({
                "file": run.file, "seconds": run.duration_s(), "rows": run.len(),
            })).collect::<Vec<_>>(),
        }),
        problems,
    })
}

/// Writes the recording so far, and beside it an account of the experiments and settings.
///
/// # Errors
/// Returns a [`Failure`] if the recording cannot be written or used.
pub fn leave(recorder: &Recorder, rig: &Rig<impl Wire>, folder: &Path) -> Result<(), Failure> {
    recorder.recording().write(folder)?;
    let path = folder.join("session.toml");
    std::fs::write(&path, rig.account()).map_err(Failure::write(&path))?;
    Ok(recorder.recording().validate()?)
}

impl Arguments {
    /// Paths that the command writes and reads.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let out = Target::of("--out", Use::NewFolder, &self.out);
        [self.nominal.target(), out].into_iter().flatten().collect()
    }
}
