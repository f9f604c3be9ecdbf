//! `paddle gap diagnose`: where a gap lies, which effect causes it, how far it shrinks.

use super::batch;
use super::results::{json, save_model, save_report};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::progress;
use crate::provenance::Provenance;
use crate::report::{self, Labels};
use clap::Args;
use gap::Options;
use host_sim::effects::{self, EffectError};
use std::path::PathBuf;

/// Which recording, and what to leave behind.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording
  paddle gap diagnose my-recording --report report.html --save-model corrected.toml --json diagnosis.json
  paddle gap diagnose my-recording --without presliding
  paddle gap diagnose --batch monday tuesday --json all.jsonl

Each effect of `paddle effects` is fitted by simulation and judged on data that the fit has not seen. The exit status is
0 whatever the verdict, 2 for a recording that cannot be used.

A batch leaves diagnosis, report and corrected model of each recording in --out. Called again, it does what is missing:
a result is kept if it is newer than its recording and this program and was made with the same --without.")]
pub struct Arguments {
    /// Folder of the recording.
    #[arg(required_unless_present = "batch", conflicts_with = "batch")]
    recording: Option<PathBuf>,
    /// Leave a page with plots here, one file that needs nothing else.
    #[arg(long, value_name = "FILE.html", conflicts_with = "batch")]
    report: Option<PathBuf>,
    /// Leave the corrected model here, for `paddle gap measure --model`.
    #[arg(long, value_name = "FILE.toml", conflicts_with = "batch")]
    save_model: Option<PathBuf>,
    /// Do not try this effect; may be repeated.
    #[arg(long, value_name = "NAME")]
    without: Vec<String>,
    /// Diagnose all recordings in these folders and below; one that fails stops none.
    #[arg(long, value_name = "FOLDER", num_args = 1..)]
    batch: Vec<PathBuf>,
    /// Where a batch leaves its results.
    #[arg(
        long,
        value_name = "DIR",
        requires = "batch",
        default_value = "paddle-out/diagnoses"
    )]
    out: PathBuf,
}

/// Diagnoses.
///
/// # Errors
/// [`Failure`] for a recording that cannot be used, and for files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let options = options(&arguments.without)?;
    let Some(folder) = &arguments.recording else {
        return batch::run(&arguments.batch, &arguments.out, &options);
    };
    progress::doing("reading".into());
    let recording = super::read(folder)?;
    let provenance = Provenance::of(folder, &recording)?;
    let outcome = gap::diagnose(&recording, &options);
    let mut text = report::text(&outcome.diagnosis, &Labels::of(&recording));
    if let Some(path) = &arguments.save_model {
        save_model(path, &recording, &outcome)?;
        text.push_str(&format!("corrected model in {}\n", path.display()));
    }
    if let Some(path) = &arguments.report {
        progress::doing("drawing the report".into());
        save_report(path, &recording, &outcome, &provenance)?;
        text.push_str(&format!("report in {}\n", path.display()));
    }
    Ok(Answer {
        text,
        json: json(&outcome, &provenance),
        ..Answer::default()
    })
}

/// The options, unless a name is misspelt.
fn options(without: &[String]) -> Result<Options, Failure> {
    match without.iter().find(|name| effects::kind(name).is_none()) {
        Some(unknown) => Err(EffectError::Kind(unknown.clone()).into()),
        None => Ok(Options {
            without: without.to_vec(),
            progress: |stage| progress::doing(stage.to_string()),
        }),
    }
}
