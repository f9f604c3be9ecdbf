//! `paddle gap diagnose`: where a gap lies, which effect causes it, how far it shrinks.

use crate::answer::Answer;
use crate::failure::Failure;
use crate::report::{self, Labels};
use clap::Args;
use gap::{ModelFile, Options, Outcome};
use host_sim::effects::{self, EffectError};
use recording::Recording;
use std::path::{Path, PathBuf};

/// Which recording, and what to leave behind.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording
  paddle gap diagnose my-recording --save-model corrected.toml --json diagnosis.json
  paddle gap diagnose my-recording --without presliding

Each effect of `paddle effects` is fitted by simulation and judged on data that the fit has not seen. The exit status is
0 whatever the verdict, 2 for a recording that cannot be used.")]
pub struct Arguments {
    /// Folder of the recording.
    recording: PathBuf,
    /// Leave the corrected model here, for `paddle gap measure --model`.
    #[arg(long, value_name = "FILE.toml")]
    save_model: Option<PathBuf>,
    /// Do not try this effect; may be repeated.
    #[arg(long, value_name = "NAME")]
    without: Vec<String>,
}

/// Diagnoses.
///
/// # Errors
/// [`Failure`] for a recording that cannot be used, and for files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let options = options(&arguments.without)?;
    let recording = Recording::read(&arguments.recording)?;
    let outcome = gap::diagnose(&recording, &options);
    let mut text = report::text(&outcome.diagnosis, &Labels::of(&recording));
    let files = Files {
        model: arguments.save_model.as_deref(),
    };
    text.push_str(&files.leave(&recording, &outcome)?);
    Ok(Answer {
        text,
        json: json(&outcome),
    })
}

/// The options, unless a name is misspelt.
fn options(without: &[String]) -> Result<Options, Failure> {
    match without.iter().find(|name| effects::kind(name).is_none()) {
        Some(unknown) => Err(EffectError::Kind(unknown.clone()).into()),
        None => Ok(Options {
            without: without.to_vec(),
        }),
    }
}

/// The diagnosis in the recording format's JSON.
fn json(outcome: &Outcome) -> serde_json::Value {
    // Maps with text keys and numbers cannot fail.
    serde_json::to_value(&outcome.diagnosis).unwrap_or_default()
}

/// What is left behind beside the answer.
struct Files<'a> {
    model: Option<&'a Path>,
}

impl Files<'_> {
    /// Writes them, and says where.
    fn leave(&self, recording: &Recording, outcome: &Outcome) -> Result<String, Failure> {
        let mut text = String::new();
        let mut leave = |what: &str, path: &Path, content: &str| {
            std::fs::write(path, content).map_err(Failure::write(path))?;
            text.push_str(&format!("{what} in {}\n", path.display()));
            Ok::<_, Failure>(())
        };
        if let Some(path) = self.model {
            let file = ModelFile::new(&outcome.model, recording);
            leave("corrected model", path, &file.to_string())?;
        }
        Ok(text)
    }
}
