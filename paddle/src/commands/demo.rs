//! `paddle demo`: a step response and a gap.

use super::gap::measure;
use super::sim;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::Folder;
use clap::Args;
use host_sim::device::Device;
use recording::Recording;
use serde_json::json;
use std::path::PathBuf;

/// Where to.
#[derive(Args)]
#[command(after_help = "Example: paddle demo

The recording was made by `paddle sim` with something hidden in it that its nominal model does not have.")]
pub struct Arguments {
    /// Leave plots, CSVs and the recording in this folder.
    #[arg(long, default_value = "paddle-out/demo", value_name = "DIR")]
    out: PathBuf,
}

/// The recording, as files of its folder.
const RECORDING: [(&str, &str); 2] = [
    ("recording.toml", include_str!("../../demo/recording.toml")),
    ("multisine.csv", include_str!("../../demo/multisine.csv")),
];

/// Demonstrates.
///
/// # Errors
/// [`Failure`] for files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let step = sim::step_of_refit(&arguments.out)?;
    let mut folder = Folder::make(&arguments.out.join("recording"))?;
    for (name, text) in RECORDING {
        folder.put(name, text)?;
    }
    let recording = Recording::read(folder.path())?;
    let (gap, runs) = gap::measure(&recording, &Device::nominal(&recording.model));
    let mut predictions = Folder::make(&arguments.out.join("gap"))?;
    for run in &runs {
        measure::leave(&mut predictions, run, &gap)?;
    }
    let files: Vec<_> = folder.files().iter().chain(predictions.files()).collect();
    let listed: String = files
        .iter()
        .map(|file| format!("  {}\n", file.display()))
        .collect();
    let text = format!(
        "{}\nThe nominal model on the bundled recording, which has something hidden in it\n  {}{listed}\nEverything is in {}\n",
        step.text,
        measure::sentence(&gap),
        arguments.out.display()
    );
    Ok(Answer {
        text,
        json: json!({ "step": step.json, "gap": gap, "files": files, "folder": arguments.out }),
        ..Answer::default()
    })
}
