//! `paddle gap diagnose`: where a gap lies, which effect causes it, how far it shrinks.

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

/// Which recording, and what to leave behind.
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
    /// Write a page with plots to this file, one file that needs nothing else.
    #[arg(long, value_name = "FILE.html", conflicts_with = "batch")]
    report: Option<PathBuf>,
    /// Write the corrected model to this file, for `paddle gap measure --model`.
    #[arg(long, value_name = "FILE.toml", conflicts_with = "batch")]
    save_model: Option<PathBuf>,
    /// Leave the numbers of the nominal model out of the corrected one, so that its effects can be laid over another: a
    /// model that was found with one load, on a recording with another.
    #[arg(long, requires = "save_model")]
    effects_only: bool,
    /// Add a table of the torque that is still missing to the saved model, if that predicts held-out data better.
    #[arg(long, requires = "save_model")]
    with_tables: bool,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Leave the corrected model for a simulator: mjcf, urdf, usd, simulink-m, python or console; may be repeated. Without
    /// a file it is `corrected` in the working folder, with the format's extension.
    #[arg(long, value_name = "FORMAT[=FILE]", conflicts_with = "batch")]
    export: Vec<Destination>,
    /// Do not try this effect; may be repeated.
    #[arg(long, value_name = "NAME")]
    without: Vec<String>,
    /// Diagnose all recordings in these folders and below; one that fails stops none.
    #[arg(long, value_name = "FOLDER", num_args = 1..)]
    batch: Vec<PathBuf>,
    /// Diagnose the part K of N of a batch: every N-th recording from the K-th on, so that N machines share it.
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

/// Diagnoses.
///
/// # Errors
/// [`Failure`] for a recording that cannot be used, and for files that cannot be written.
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
    let mut amiss = Vec::new();
    let mut say = |what: &str, path: &Path, saved: Result<(), Failure>| match saved {
        Ok(()) => text.push_str(&format!("{what} in {}\n", path.display())),
        Err(failure) => amiss.push(failure),
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
        amiss,
    })
}

/// Adds a table to the corrected model, if one closes something; says what came of it.
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
    /// Where it will write.
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

/// The options, unless a name is misspelt.
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

/// Share of the time of a diagnosis that has usually passed when a stage begins, for a time left that is a guess: how many
/// effects will be looked for, nobody knows. Of one that named one effect in 3.75 million rows; with each further effect the
/// search begins anew, and so does the guess.
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
