//! `paddle demo`: simulates a step response and diagnoses a gap. With `--board` it does all steps on the virtual board.

mod board;

use crate::answer::Answer;
use crate::commands::gap::{measure, results};
use crate::commands::sim;
use crate::failure::Failure;
use crate::files::Folder;
use crate::provenance::Provenance;
use crate::report::{self, Labels};
use crate::targets::{Target, Use};
use clap::Args;
use gap::{ModelFile, Options};
use host_sim::device::Device;
use recording::Recording;
use serde_json::json;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle demo
  paddle demo --board
  paddle demo --board --with torque_gain:gain=0.6

A step of the simulated paddle, and a recording that was made by `paddle sim` with something hidden in it that its nominal
model does not have: how large the gap is, what causes it, and the model that closes it.

With --board the loop is closed, without hardware: a virtual board whose paddle has something hidden in it, experiments over
its serial port until the diagnosis names it, gains for the corrected model, and a step with the old and the new gains. That
takes some minutes.")]
pub struct Arguments {
    /// Write the plots, the CSV files, the recording and its report to this folder.
    #[arg(long, default_value = "paddle-out/demo", value_name = "DIR")]
    out: PathBuf,
    /// Run the complete procedure on the virtual board: experiments, diagnosis, tuning and step responses.
    #[arg(long)]
    board: bool,
    /// Effect that is hidden in the board's paddle.
    #[arg(
        long,
        requires = "board",
        default_value = "torque_gain:gain=0.6",
        value_name = "EFFECT:PARAMETER=VALUE,..."
    )]
    with: String,
}

/// Names and contents of the files of the bundled recording.
const RECORDING: [(&str, &str); 2] = [
    (
        "recording.toml",
        include_str!("../../../demo/recording.toml"),
    ),
    ("multisine.csv", include_str!("../../../demo/multisine.csv")),
];

/// Runs the demonstration.
///
/// # Errors
/// Returns a [`Failure`] if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let out = &arguments.out;
    if arguments.board {
        return board::run(&board::folder(out), &arguments.with);
    }
    let step = sim::step_of_refit(out)?;
    let mut folder = Folder::new(&out.join("recording"));
    for (name, text) in RECORDING {
        folder.put(name, text);
    }
    let recording = Recording::read(folder.path())?;
    let (gap, runs) = gap::measure(&recording, &Device::nominal(&recording.model));
    let mut predictions = Folder::new(&out.join("gap"));
    for run in &runs {
        measure::leave(&mut predictions, run, &gap);
    }
    let provenance = Provenance::of(folder.path(), &recording)?;
    let outcome = gap::diagnose(&recording, &Options::default());
    let mut diagnosis = Folder::new(out);
    diagnosis.draw(
        "report.html",
        report::page(&recording, &outcome, &provenance),
    );
    diagnosis.put(
        "corrected.toml",
        &ModelFile::new(&outcome.model, &recording).to_string(),
    );

    let folders = [&folder, &predictions, &diagnosis];
    let files: Vec<_> = folders.into_iter().flat_map(Folder::files).collect();
    let listed: String = files
        .iter()
        .map(|file| format!("  {}\n", file.display()))
        .collect();
    let text = format!(
        "{}\nThe nominal model on the bundled recording, which has something hidden in it\n  {}\n{}{listed}\nEverything is in {}; open {}\n",
        step.text,
        measure::sentence(&gap),
        report::text(&outcome.diagnosis, &Labels::of(&recording)),
        out.display(),
        out.join("report.html").display(),
    );
    Ok(Answer {
        text,
        json: json!({
            "step": step.json,
            "gap": gap,
            "diagnosis": results::json(&recording, &outcome, &provenance),
            "files": files,
            "folder": out,
        }),
        problems: [folder, predictions, diagnosis]
            .into_iter()
            .flat_map(Folder::lost)
            .chain(step.problems)
            .collect(),
    })
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("--out", Use::Folder, &self.out)
            .into_iter()
            .collect()
    }
}
