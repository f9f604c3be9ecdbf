//! `paddle gap init`: writes a commented `recording.toml` for CSV files that already have the columns of the format.

use super::import::{answer, leave_manifest, shown};
use super::known::{DeviceKind, KnownArguments};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::{Target, Use};
use clap::{Args, ValueEnum};
use import::{ImportError, Recipe};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;

/// Options that describe the device.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap init my-recording
  paddle gap init my-recording --kind pendulum --mass 0.075 --lever 0.02 --gear 15
  paddle gap init my-recording --gear 15 --motor kt=0.0538,resistance=10.6 --unit V

The folder holds CSV files with the columns time, input and position; logs with other columns go through `paddle gap
import`. What is not known is left out, and the diagnosis estimates it. The format: docs/recording-format.md")]
pub struct Arguments {
    /// Folder with the CSV files.
    folder: PathBuf,
    /// Unit of the input: 'N m', A, V or duty.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Ask no questions.
    #[arg(long)]
    yes: bool,
    /// Overwrite an existing recording.toml.
    #[arg(long)]
    force: bool,
    /// The input is the output of a feedback controller.
    #[arg(long)]
    closed_loop: bool,
    /// Length of a prediction window, s.
    #[arg(long, value_name = "S")]
    horizon: Option<f64>,
    /// Title of the recording.
    #[arg(long)]
    title: Option<String>,
    #[command(flatten)]
    known: KnownArguments,
}

/// Writes the manifest.
///
/// # Errors
/// Returns a [`Failure`] if a file does not follow the format, or if the options contradict each other.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let folder = &arguments.folder;
    let manifest = folder.join("recording.toml");
    if manifest.exists() && !arguments.force {
        return Err(ImportError::Option(format!(
            "{} is there already; --force writes over it",
            manifest.display()
        ))
        .into());
    }
    let entries = std::fs::read_dir(folder).map_err(Failure::read(folder))?;
    let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<PathBuf> = files
        .filter(|path| {
            path.extension()
                .is_some_and(|ext| ext.eq_ignore_ascii_case("csv"))
        })
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(ImportError::Option(format!(
            "{} holds no CSV; put one there for each run, or import logs by `paddle gap import`",
            folder.display()
        ))
        .into());
    }
    let logs = files
        .iter()
        .map(|path| import::read_log(path))
        .collect::<Result<Vec<_>, _>>()?;
    for (log, path) in logs.iter().zip(&files) {
        if let Some(missing) = ["time", "input", "position"]
            .iter()
            .find(|name| log.columns.iter().all(|column| column.name != **name))
        {
            return Err(ImportError::Option(format!(
                "{}: column `{missing}` is missing; bring the log into the format by `paddle gap import {} --out DIR`",
                path.display(),
                path.display()
            ))
            .into());
        }
    }
    let recipe = Recipe {
        is_closed_loop: arguments.closed_loop,
        horizon_s: arguments.horizon,
        title: arguments.title.clone(),
        // Each file is one run; it is not split.
        split_gap_s: Some(f64::INFINITY),
        ..Recipe::default()
    };
    let mut imported = import::import(&logs, &recipe)?;
    for (run, path) in imported.recording.runs.iter_mut().zip(&files) {
        run.file = path.file_name().map_or_else(
            || run.file.clone(),
            |name| name.to_string_lossy().into_owned(),
        );
    }
    if let Some(unit) = &arguments.unit {
        unit.clone_into(&mut imported.recording.units.input);
    }
    let mut known = arguments.known.known()?;
    let may_ask = !arguments.yes && arguments.known.is_empty() && std::io::stdin().is_terminal();
    if may_ask {
        ask(&mut known, &mut imported.recording.units.input);
    }
    let text = import::manifest(&imported.recording, &known, &imported.roles, false)?;
    let mut warnings = leave_manifest(folder, &text)?;
    warnings.extend(known.unstated_warning());
    Ok(answer(shown(&imported), &imported, warnings, folder))
}

/// Asks the user at a terminal. An empty reply means that the value is not known.
fn ask(known: &mut import::Known, unit: &mut String) {
    let kind = asked("What moves: rotary, pendulum, linear or servo?");
    if let Some(kind) = kind.and_then(|kind| DeviceKind::from_str(&kind, true).ok()) {
        known.kind = match kind {
            DeviceKind::Rotary => import::Kind::Rotary,
            DeviceKind::Pendulum => import::Kind::Pendulum,
            DeviceKind::Linear => import::Kind::Linear,
            DeviceKind::Servo => import::Kind::Servo,
        };
    }
    if let Some(told) = asked("Unit of the input: 'N m', A, V or duty?") {
        *unit = told;
    }
    let number = |question: &str| asked(question).and_then(|reply| reply.parse::<f64>().ok());
    known.motor.gear = number("Turns of the motor per turn of the joint?");
    if matches!(unit.as_str(), "A" | "V" | "duty") {
        known.motor.kt = number("Torque constant of the motor, N m/A?");
    }
    if matches!(unit.as_str(), "V" | "duty") {
        known.motor.resistance = number("Resistance of its winding, Ohm?");
    }
    if unit == "duty" {
        known.motor.supply = number("Supply, V?");
    }
    known.mass_kg = number("Mass that moves, kg?");
    if known.kind != import::Kind::Linear {
        known.lever_m = number("From the axis to its centre, m?");
    }
}

fn asked(question: &str) -> Option<String> {
    let mut out = std::io::stderr();
    let mut reply = String::new();
    write!(out, "{question} (Enter if not known) ")
        .and_then(|()| out.flush())
        .ok()?;
    std::io::stdin().read_line(&mut reply).ok()?;
    Some(reply.trim().to_owned()).filter(|reply| !reply.is_empty())
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("FOLDER", Use::Folder, &self.folder)
            .into_iter()
            .collect()
    }
}
