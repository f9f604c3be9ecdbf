//! `paddle gap diagnose --batch`: diagnoses many recordings in one call, and continues an interrupted batch.

use super::results::{json, save_model, save_report};
use super::usable;
use crate::answer::{Answer, rounded};
use crate::failure::Failure;
use crate::progress;
use crate::provenance::Provenance;
use gap::{Options, Outcome, Recording};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

const MANIFEST: &str = "recording.toml";

/// A part of a batch: every `of_all`-th recording, beginning with recording number `place`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    place: usize,
    of_all: usize,
}

impl Shard {
    fn part<T>(self, all: Vec<T>) -> Vec<T> {
        all.into_iter()
            .skip(self.place - 1)
            .step_by(self.of_all)
            .collect()
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let numbers =
            parts.and_then(|(place, of_all)| Some((place.parse().ok()?, of_all.parse().ok()?)));
        match numbers {
            Some((place, of_all)) if (1..=of_all).contains(&place) => Ok(Self { place, of_all }),
            _ => Err("write K/N, K from 1 to N, as in 2/8".into()),
        }
    }
}

/// A recording of the batch.
struct Case {
    folder: PathBuf,
    /// Path of its results, without extension.
    results: PathBuf,
}

/// A folder without recordings, and the failure.
type Refused = (PathBuf, Failure);

/// Diagnoses all recordings in `folders` and their subfolders.
///
/// # Errors
/// Returns a [`Failure`] if no folder contains a recording. Recordings that cannot be used, folders without recordings, and
/// results that cannot be written are reported in the answer.
pub fn run(
    folders: &[PathBuf],
    out: &Path,
    shard: Option<Shard>,
    options: &Options,
) -> Result<Answer, Failure> {
    let (mut cases, mut refused) = cases(folders, out)?;
    if let Some(shard) = shard {
        cases = shard.part(cases);
        // A folder without recordings is reported by the first shard only.
        refused.retain(|_| shard.of_all == 1 || shard.place == 1);
    }
    let all = cases.len() + refused.len();
    let mut lines = Vec::with_capacity(all);
    let mut table = format!(
        "{:<48}{:<18}{:>7}  effects\n",
        "recording", "verdict", "shrink"
    );
    let mut failed = refused.len();
    let mut problems = Vec::new();
    for (folder, failure) in refused {
        let line = not_used(&folder, &failure);
        // Writing to a String cannot fail.
        let _ = writeln!(table, "{}", row(&folder, &line));
        lines.push(line);
    }
    for case in &cases {
        let place = lines.len() + 1;
        let of = format!("{place} of {all}, {}", case.folder.display());
        progress::within(&of);
        let line = match kept(case, options) {
            Some(line) => line,
            None => match diagnosed(case, options) {
                Ok((line, saved)) => {
                    problems.extend(saved.err());
                    line
                }
                Err(failure) => {
                    failed += 1;
                    not_used(&case.folder, &failure)
                }
            },
        };
        let row = row(&case.folder, &line);
        progress::done(&format!("{place}/{all} {row}"));
        let _ = writeln!(table, "{row}");
        lines.push(line);
    }
    let _ = writeln!(table, "\n{}\nresults in {}", tally(&lines), out.display());
    problems.extend((failed > 0).then_some(Failure::Batch { failed, all }));
    Ok(Answer {
        text: table,
        json: Value::Array(lines),
        problems,
    })
}

/// Lists the recordings in `folders` and their subfolders, each once, sorted by name. Also lists the folders without
/// recordings.
fn cases(folders: &[PathBuf], out: &Path) -> Result<(Vec<Case>, Vec<Refused>), Failure> {
    let mut all = Vec::new();
    let mut refused = Vec::new();
    for folder in folders {
        let mut found = Vec::new();
        match collect(folder, &mut BTreeSet::new(), &mut found) {
            Ok(()) if found.is_empty() => {
                refused.push((folder.clone(), Failure::NoRecording(folder.clone())));
            }
            Ok(()) => {
                found.sort();
                all.extend(found);
            }
            Err(failure) => refused.push((folder.clone(), failure)),
        }
    }
    if all.is_empty() && !refused.is_empty() {
        return Err(refused.swap_remove(0).1);
    }
    let mut cases: Vec<Case> = Vec::with_capacity(all.len());
    for folder in all {
        let folder = folder.canonicalize().map_err(Failure::read(&folder))?;
        if cases.iter().all(|case| case.folder != folder) {
            let results = out.join(relative(&folder));
            cases.push(Case { folder, results });
        }
    }
    Ok((cases, refused))
}

/// Adds the recordings in `folder` and its subfolders. `entered` lists the folders already visited, because links can form
/// loops.
fn collect(
    folder: &Path,
    entered: &mut BTreeSet<PathBuf>,
    found: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    let refused = || Failure::read(folder);
    if !entered.insert(folder.canonicalize().map_err(refused())?) {
        return Ok(());
    }
    if folder.join(MANIFEST).is_file() {
        found.push(folder.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(folder).map_err(refused())? {
        let below = entry.map_err(refused())?.path();
        if below.is_dir() {
            collect(&below, entered, found)?;
        }
    }
    Ok(())
}

/// Path of `folder` relative to the working folder, or else from the root. Two recordings never have the same path.
fn relative(folder: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| folder.strip_prefix(here).ok());
    let named = below.filter(|below| !below.as_os_str().is_empty());
    let names = named.unwrap_or(folder).components();
    names
        .filter(|name| matches!(name, Component::Normal(_)))
        .collect()
}

/// Appends an extension to `path`, even if the name contains dots.
fn with(path: &Path, extension: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

/// Diagnoses one recording and writes its results.
fn diagnosed(case: &Case, options: &Options) -> Result<(Value, Result<(), Failure>), Failure> {
    let recording = usable::read(&case.folder)?;
    let provenance = Provenance::of(&case.folder, &recording)?;
    let diagnosis = AssertUnwindSafe(|| gap::diagnose(&recording, options));
    let outcome = catch_unwind(diagnosis).map_err(|_| Failure::Fault)?;
    let mut line = stamped(json(&recording, &outcome, &provenance), case, options);
    rounded(&mut line);
    let saved = save(case, &recording, &outcome, &provenance, &line);
    Ok((line, saved))
}

/// Writes the results of one recording. The JSON file is written last, because its presence means that the others are
/// complete.
fn save(
    case: &Case,
    recording: &Recording,
    outcome: &Outcome,
    provenance: &Provenance,
    line: &Value,
) -> Result<(), Failure> {
    if let Some(parent) = case.results.parent() {
        std::fs::create_dir_all(parent).map_err(Failure::write(parent))?;
    }
    save_model(&with(&case.results, "toml"), recording, outcome, false)?;
    let page = with(&case.results, "html");
    save_report(&page, recording, outcome, provenance)?;
    let (begun, whole) = (
        with(&case.results, "json.part"),
        with(&case.results, "json"),
    );
    std::fs::write(&begun, format!("{line:#}\n")).map_err(Failure::write(&begun))?;
    std::fs::rename(&begun, &whole).map_err(Failure::write(&whole))
}

/// Adds the name of the recording and the options to a diagnosis.
fn stamped(mut diagnosis: Value, case: &Case, options: &Options) -> Value {
    if let Value::Object(keys) = &mut diagnosis {
        keys.insert("recording".into(), json!(case.folder));
        keys.insert("without".into(), json!(options.without));
    }
    diagnosis
}

/// Reads the result of an earlier call, if a new call would give the same result.
fn kept(case: &Case, options: &Options) -> Option<Value> {
    let path = with(&case.results, "json");
    let line: Value = serde_json::from_str(&std::fs::read_to_string(&path).ok()?).ok()?;
    let of_this =
        line["recording"] == json!(case.folder) && line["without"] == json!(options.without);
    let made = changed(&path)?;
    let files = std::fs::read_dir(&case.folder).ok()?;
    let recorded = files.filter_map(|file| changed(&file.ok()?.path())).max()?;
    let built = changed(&std::env::current_exe().ok()?)?;
    (of_this && made > recorded && made > built).then_some(line)
}

fn changed(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}

/// JSON for a folder that could not be diagnosed.
fn not_used(folder: &Path, failure: &Failure) -> Value {
    json!({ "recording": folder, "error": failure.to_string() })
}

/// Formats a recording as one line of the table.
fn row(folder: &Path, line: &Value) -> String {
    let name = relative(folder).display().to_string();
    if let Some(error) = line["error"].as_str() {
        return format!("{name:<48}{:<18}{:>7}  {error}", "not used", "");
    }
    let effects = line["effects"].as_array().into_iter().flatten();
    let names: Vec<_> = effects
        .filter_map(|effect| effect["name"].as_str())
        .collect();
    let verdict = line["verdict"].as_str().unwrap_or_default();
    let shrink = match (names.is_empty(), line["gap"]["shrink"].as_f64()) {
        (false, Some(shrink)) => format!("{shrink:.2}"),
        _ => String::new(),
    };
    format!("{name:<48}{verdict:<18}{shrink:>7}  {}", names.join(", "))
        .trim_end()
        .to_owned()
}

/// Counts the recordings per verdict.
fn tally(lines: &[Value]) -> String {
    const VERDICTS: [&str; 4] = ["no_gap", "explained", "partly_explained", "unexplained"];
    let count = |verdict: &str| {
        lines
            .iter()
            .filter(|line| line["verdict"] == verdict)
            .count()
    };
    let mut parts: Vec<_> = VERDICTS
        .iter()
        .map(|verdict| (*verdict, count(verdict)))
        .collect();
    parts.push((
        "not used",
        lines
            .iter()
            .filter(|line| line.get("error").is_some())
            .count(),
    ));
    parts.retain(|(_, count)| *count > 0);
    let parts: Vec<_> = parts
        .iter()
        .map(|(verdict, count)| format!("{count} {verdict}"))
        .collect();
    parts.join(", ")
}
