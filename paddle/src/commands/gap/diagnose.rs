//! `paddle gap diagnose`: locates a gap, names the effect that causes it, and reports how much the effect reduces it.

use super::batch::{self, Shard};
use super::own_effects::OwnEffects;
use super::results::{json, save_model, save_report};
use super::simulator::{self, Corrected, Destination};
use super::usable;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files;
use crate::progress;
use crate::provenance::Provenance;
use crate::report::{self, Labels, missing_torque};
use crate::targets::{Target, Use};
use clap::Args;
use gap::diagnosis::Verdict;
use gap::{Options, Outcome, Recording, Stage, Tabulated, tabulated};
use host_sim::effects::{self, EffectError};
use std::path::{Path, PathBuf};

/// Options of the diagnosis and of its output.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording
  paddle gap diagnose my-recording --report report.html --save-model corrected.toml --json diagnosis.json
  paddle gap diagnose my-recording --export mjcf=paddle.xml --export urdf
  paddle gap diagnose my-recording --without presliding
  paddle gap diagnose my-recording --effect eddy-brake.toml               # see docs/own-effects.md
  paddle gap diagnose --batch monday tuesday --json all.jsonl
  paddle gap diagnose --batch fleet --shard 2/8 --json shard-2.jsonl     # see docs/many-recordings.md

Each effect of `paddle effects` is fitted by simulation and judged on data that the fit has not seen. The exit status is
0 whatever the verdict, 2 for a recording that cannot be used.

A batch leaves diagnosis, report and corrected model of each recording in --out. Called again, it does what is missing:
a result is kept if it is newer than its recording and this program and was made with the same --without.")]
pub struct Arguments {
    /// Folder of the recording.
    #[arg(required_unless_present = "batch", conflicts_with = "batch")]
    recording: Option<PathBuf>,
    /// Write a report with plots to this file. The page is self-contained.
    #[arg(long, value_name = "FILE.html", conflicts_with = "batch")]
    report: Option<PathBuf>,
    /// Write the corrected model to this file, for `paddle gap measure --model`.
    #[arg(long, value_name = "FILE.toml", conflicts_with = "batch")]
    save_model: Option<PathBuf>,
    /// Save only the effects, without the numbers of the nominal model. The effects can then be applied to another nominal
    /// model, for instance one with another load.
    #[arg(long, requires = "save_model")]
    effects_only: bool,
    /// Add a table of the remaining torque error to the saved model, if the table improves the prediction of held-out data.
    #[arg(long, requires = "save_model")]
    with_tables: bool,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Write the corrected model for a simulator: mjcf, urdf, usd, simulink-m, python or console; may be repeated. The
    /// default file is `corrected` in the working folder, with the extension of the format.
    #[arg(long, value_name = "FORMAT[=FILE]", conflicts_with = "batch")]
    export: Vec<Destination>,
    /// Exclude this effect from the search; may be repeated.
    #[arg(long, value_name = "NAME")]
    without: Vec<String>,
    /// Diagnose all recordings in these folders and their subfolders. A recording that fails does not stop the batch.
    #[arg(long, value_name = "FOLDER", num_args = 1..)]
    batch: Vec<PathBuf>,
    /// Diagnose part K of N of a batch: every N-th recording, beginning with the K-th, so that N machines can share the
    /// work.
    #[arg(long, value_name = "K/N", requires = "batch")]
    shard: Option<Shard>,
    /// Folder for the results of a batch.
    #[arg(
        long,
        value_name = "DIR",
        requires = "batch",
        default_value = "paddle-out/diagnoses"
    )]
    out: PathBuf,
}

/// Runs the diagnosis.
///
/// # Errors
/// Returns a [`Failure`] if a recording cannot be used, and if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.own_effects.add()?;
    let options = options(&arguments.without)?;
    let Some(folder) = &arguments.recording else {
        return batch::run(&arguments.batch, &arguments.out, arguments.shard, &options);
    };
    let recording = usable::read(folder)?;
    if !arguments.export.is_empty() {
        simulator::check_units(folder, &recording)?;
    }
    let provenance = Provenance::of(folder, &recording)?;
    let mut outcome = gap::diagnose(&recording, &options);
    let mut text = report::text(&outcome.diagnosis, &Labels::of(&recording));
    if outcome.diagnosis.verdict == Verdict::Unexplained {
        text.push_str(&missing_torque::unexplained(&recording));
    }
    if arguments.with_tables {
        text.push_str(&with_table(&recording, &mut outcome));
    }
    let mut problems = Vec::new();
    let mut say = |what: &str, path: &Path, saved: Result<(), Failure>| match saved {
        Ok(()) => text.push_str(&format!("{what} in {}\n", path.display())),
        Err(failure) => problems.push(failure),
    };
    if let Some(path) = &arguments.save_model {
        say(
            "corrected model",
            path,
            save_model(path, &recording, &outcome, arguments.effects_only),
        );
    }
    for Destination { format, path } in &arguments.export {
        let corrected = Corrected::of_outcome(folder, &recording, &outcome);
        let left = corrected.and_then(|corrected| {
            let written = corrected.written(*format);
            files::leave(path, &written.exported.text).map(|()| written.lacks())
        });
        let lacks = left.as_deref().unwrap_or_default();
        let what = format!("{lacks}model for {}", format.name());
        say(&what, path, left.map(drop));
    }
    if let Some(path) = &arguments.report {
        progress::doing("drawing the report".into());
        let saved = save_report(path, &recording, &outcome, &provenance);
        say("report", path, saved);
    }
    Ok(Answer {
        text,
        json: json(&recording, &outcome, &provenance),
        problems,
    })
}

/// Adds a table to the corrected model if it reduces the gap. Returns a sentence about the result.
fn with_table(recording: &Recording, outcome: &mut Outcome) -> String {
    match tabulated(recording, &outcome.model) {
        Tabulated::Closes { table, shrink } => {
            let axis = table.axis.name();
            outcome.model.tables.push(table);
            let percent = 100.0 * shrink;
            format!(
                "a table over {axis} of the torque that is still missing closes {percent:.0} % of what is left, on data that it was not made from; it is in the saved model\n"
            )
        }
        Tabulated::Repeats => {
            "the motion only repeats itself: a table of the missing torque would only remember it\n".to_owned()
        }
        Tabulated::ClosesNothing => {
            "no table over velocity, position or input closes more on data that it was not made from\n".to_owned()
        }
    }
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let report = Target::of("--report", Use::File, self.report.as_ref());
        let model = Target::of("--save-model", Use::File, self.save_model.as_ref());
        let exports = self.export.iter();
        let exports = exports.filter_map(|export| Target::of("--export", Use::File, &export.path));
        let is_batch = !self.batch.is_empty();
        let out = Target::of("--out", Use::Folder, is_batch.then_some(&self.out));
        [report, model, out]
            .into_iter()
            .flatten()
            .chain(exports)
            .collect()
    }
}

/// Options of the diagnosis. Fails if the name of an effect is unknown.
pub fn options(without: &[String]) -> Result<Options, Failure> {
    match without.iter().find(|name| effects::kind(name).is_none()) {
        Some(unknown) => Err(EffectError::Kind(unknown.clone()).into()),
        None => Ok(Options {
            without: without.to_vec(),
            progress: |stage| {
                if stage == Stage::Windows {
                    progress::begin();
                }
                progress::part_done(usually_done(stage));
                progress::doing(stage.to_string());
            },
        }),
    }
}

/// Typical share of the diagnosis time that has passed when a stage begins. The estimate of the remaining time is rough,
/// because the number of effects is not known in advance. Each further effect repeats the search and restarts the estimate.
fn usually_done(stage: Stage) -> f64 {
    match stage {
        Stage::Windows => 0.0,
        Stage::Nominal => 0.18,
        Stage::Screening => 0.2,
        Stage::Finalists => 0.55,
        Stage::Judging => 0.7,
        Stage::Shrink => 0.82,
        Stage::Where => 0.9,
        Stage::NextExperiment => 0.98,
    }
}
