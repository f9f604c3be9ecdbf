//! Runs the whole check: makes a case, has another process diagnose it, opens the truth, and scores the answer.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::case::{Case, CaseError, Mixture};
use crate::diagnosis::{Diagnosis, Gap};
use crate::score::{FreshGaps, Gaps, Outcome, Summary, judge};

/// Settings of one check.
#[derive(Clone, Debug)]
pub struct Check {
    /// The program that provides `gap diagnose` and `gap measure`.
    pub program: PathBuf,
    /// Folder for all cases. It must be empty or not exist.
    pub folder: PathBuf,
    /// Number of cases.
    pub cases: u64,
    /// Seed of the set.
    pub seed: u64,
    /// Which cases are drawn.
    pub mixture: Mixture,
    /// The file of the effect of the user that is hidden, for the library of the diagnosis.
    pub own_effect: Option<PathBuf>,
    /// An effect to remove from the library of the diagnosis.
    pub withheld: Option<String>,
    /// Number of cases processed in parallel.
    pub jobs: usize,
    /// Time limit of one diagnosis. A diagnosis that exceeds it counts as failed.
    pub patience: Duration,
}

/// Why a check stops.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// A case could not be made.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A recording could not be written.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// The folder already holds files, which could be results of another check.
    #[error("{} is not empty; name another folder", .0.display())]
    NotEmpty(PathBuf),
    /// A file could not be written.
    #[error("cannot write {}: {source}; name another place", .path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The program could not be started.
    #[error("cannot run {}: {source}; name a program that can be run", .path.display())]
    Program {
        /// The program.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
}

impl Check {
    /// Makes and scores all cases. Calls `report` with each outcome as soon as it is known.
    ///
    /// # Errors
    ///
    /// [`CheckError`]. A failed diagnosis is not an error: it is scored as a wrong answer.
    pub fn run(&self, report: impl Fn(&Outcome) + Sync) -> Result<Summary, CheckError> {
        let mut outcomes = self.each(|number| {
            let outcome = self.score_case(number)?;
            report(&outcome);
            Ok(outcome)
        })?;
        outcomes.sort_by_key(|outcome| outcome.case);
        Ok(Summary::of(outcomes))
    }

    /// Makes all cases and writes them with their truths. Runs no diagnosis.
    ///
    /// # Errors
    ///
    /// [`CheckError`].
    pub fn generate(&self) -> Result<(), CheckError> {
        self.each(|number| {
            let case = Case::make(self.seed, number, &self.mixture)?;
            let folder = self.case_folder(number);
            case.recording.write(folder.join(RECORDING))?;
            write_truth(&case, &folder)
        })
        .map(|_| ())
    }

    /// Checks that the folder is empty or does not exist.
    ///
    /// # Errors
    ///
    /// [`CheckError::NotEmpty`].
    pub fn ready(&self) -> Result<(), CheckError> {
        if fs::read_dir(&self.folder).is_ok_and(|mut entries| entries.next().is_some()) {
            return Err(CheckError::NotEmpty(self.folder.clone()));
        }
        Ok(())
    }

    fn each<T: Send>(
        &self,
        work: impl Fn(u64) -> Result<T, CheckError> + Sync,
    ) -> Result<Vec<T>, CheckError> {
        self.ready()?;
        let next = AtomicU64::new(1);
        let done = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..self.jobs.max(1) {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number > self.cases {
                            break;
                        }
                        let result = work(number);
                        if result.is_err() {
                            // No thread starts another case.
                            next.store(self.cases + 1, Ordering::Relaxed);
                        }
                        done.lock()
                            .unwrap_or_else(std::sync::PoisonError::into_inner)
                            .push(result);
                    }
                });
            }
        });
        done.into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .into_iter()
            .collect()
    }

    fn case_folder(&self, number: u64) -> PathBuf {
        self.folder.join(format!("case-{number:04}"))
    }

    fn score_case(&self, number: u64) -> Result<Outcome, CheckError> {
        let case = Case::make(self.seed, number, &self.mixture)?;
        let folder = self.case_folder(number);
        let recording = folder.join(RECORDING);
        case.recording.write(&recording)?;
        let model = folder.join("model.toml");
        let begun = Instant::now();
        let diagnosis = self.diagnose(&recording, &folder, &model)?;
        let took_s = begun.elapsed().as_secs_f64();
        write_truth(&case, &folder)?;
        let claims = diagnosis
            .as_ref()
            .is_some_and(|found| !found.effects.is_empty() || !found.numbers.is_empty());
        let mut gaps = Gaps::default();
        if claims && model.exists() {
            if case.truth.fresh_floor.is_some() {
                gaps.fresh = self.measure_on(&folder.join(FRESH), &model)?;
            }
            if let (Some(transfer), Some(_)) = (&case.transfer, case.truth.transfer_floor) {
                let loaded = folder.join("model-with-load.toml");
                if add_load(&model, transfer.load_inertia, &loaded)? {
                    gaps.transfer = self.measure_on(&folder.join(TRANSFER), &loaded)?;
                }
            }
        }
        let withheld = self.withheld.as_deref();
        let mut outcome = judge(&case.truth, diagnosis.as_ref(), gaps, withheld);
        // A failed diagnosis does not report its own time, so the measured time counts.
        outcome.elapsed_s.get_or_insert(took_s);
        Ok(outcome)
    }

    /// Returns `None` if the program fails or its output does not match the contract.
    fn diagnose(
        &self,
        recording: &Path,
        folder: &Path,
        model: &Path,
    ) -> Result<Option<Diagnosis>, CheckError> {
        let json = folder.join("diagnosis.json");
        let mut words = vec![
            "gap".into(),
            "diagnose".into(),
            recording.as_os_str().to_owned(),
        ];
        words.extend(["--json".into(), json.as_os_str().to_owned()]);
        words.extend(["--save-model".into(), model.as_os_str().to_owned()]);
        words.extend(self.own_effect_words());
        if let Some(withheld) = &self.withheld {
            words.extend(["--without".into(), withheld.into()]);
        }
        let path = folder.join("diagnosis.log");
        let failed = |source| CheckError::Write {
            path: path.clone(),
            source,
        };
        let log = fs::File::create(&path).map_err(failed)?;
        let mut child = Command::new(&self.program)
            .args(&words)
            .stdin(Stdio::null())
            .stdout(log.try_clone().map_err(failed)?)
            .stderr(log)
            .spawn()
            .map_err(self.not_run())?;
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().map_err(self.not_run())? {
                break status;
            }
            if begun.elapsed() > self.patience {
                // The process may have ended in the meantime, so an error of `kill` does not matter.
                let _ = child.kill();
                child.wait().map_err(self.not_run())?;
                return Ok(None);
            }
            std::thread::sleep(POLL);
        };
        if !status.success() {
            return Ok(None);
        }
        Ok(fs::read(&json)
            .ok()
            .and_then(|text| serde_json::from_slice(&text).ok()))
    }

    /// The option that adds the effect of the user to the library.
    fn own_effect_words(&self) -> Vec<OsString> {
        let own = self.own_effect.as_ref();
        let words = own.map(|path| ["--effect".into(), path.as_os_str().to_owned()]);
        words.into_iter().flatten().collect()
    }

    fn measure_on(&self, other: &Path, model: &Path) -> Result<Option<FreshGaps>, CheckError> {
        let base = [
            "gap".into(),
            "measure".into(),
            other.as_os_str().to_owned(),
            "--json".into(),
            "-".into(),
        ];
        let nominal = self.measured(&base)?;
        let with_model: Vec<_> = base
            .into_iter()
            .chain(["--model".into(), model.as_os_str().to_owned()])
            .chain(self.own_effect_words())
            .collect();
        let corrected = self.measured(&with_model)?;
        Ok(nominal
            .zip(corrected)
            .map(|(nominal, corrected)| FreshGaps {
                nominal: nominal.before,
                corrected: corrected.before,
            }))
    }

    fn measured(&self, words: &[OsString]) -> Result<Option<Gap>, CheckError> {
        #[derive(serde::Deserialize)]
        struct Measured {
            gap: Gap,
        }
        let output = self.program(words)?;
        Ok(serde_json::from_slice(&output.stdout)
            .ok()
            .map(|measured: Measured| measured.gap))
    }

    fn program(&self, words: &[OsString]) -> Result<std::process::Output, CheckError> {
        Command::new(&self.program)
            .args(words)
            .stdin(Stdio::null())
            .output()
            .map_err(self.not_run())
    }

    fn not_run(&self) -> impl Fn(std::io::Error) -> CheckError {
        let path = self.program.clone();
        move |source| CheckError::Program {
            path: path.clone(),
            source,
        }
    }
}

/// Interval at which a running diagnosis is polled. It is not the resolution of the reported time.
const POLL: Duration = Duration::from_millis(10);
const RECORDING: &str = "recording";
const FRESH: &str = "fresh";
const TRANSFER: &str = "transfer";

/// Writes the truth and the recordings that the diagnosis must not see.
fn write_truth(case: &Case, folder: &Path) -> Result<(), CheckError> {
    case.fresh.write(folder.join(FRESH))?;
    if let Some(transfer) = &case.transfer {
        transfer.recording.write(folder.join(TRANSFER))?;
    }
    let path = folder.join("truth.json");
    let text = format!("{:#}\n", serde_json::json!(case.truth));
    fs::write(&path, text).map_err(|source| CheckError::Write { path, source })
}

/// Copies the saved `model` to `loaded` and adds `load_inertia` to it. The load is known, so it is added to the inertia of
/// the model and to that of the effect `inertia`. Returns `false` if the file is not in the format that `--save-model`
/// writes.
fn add_load(model: &Path, load_inertia: f64, loaded: &Path) -> Result<bool, CheckError> {
    let text = fs::read_to_string(model).unwrap_or_default();
    let Some(text) = with_load(&text, load_inertia) else {
        return Ok(false);
    };
    let path = loaded.to_owned();
    fs::write(loaded, text).map_err(|source| CheckError::Write { path, source })?;
    Ok(true)
}

fn with_load(text: &str, load_inertia: f64) -> Option<String> {
    let mut table: toml::Table = text.parse().ok()?;
    add(table.get_mut("model")?.get_mut("inertia")?, load_inertia)?;
    let effects = table.get_mut("effects").and_then(toml::Value::as_array_mut);
    for effect in effects.into_iter().flatten() {
        if effect.get("name").and_then(toml::Value::as_str) == Some("inertia") {
            add(
                effect.get_mut("parameters")?.get_mut("inertia")?,
                load_inertia,
            )?;
        }
    }
    Some(table.to_string())
}

/// Adds `more` to a number.
fn add(value: &mut toml::Value, more: f64) -> Option<()> {
    let number = value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))?;
    *value = toml::Value::Float(number + more);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_load_is_added_to_the_model_and_to_the_effect_that_replaces_its_inertia() {
        let saved = "[model]\ninertia = 2\n[[effects]]\nname = \"inertia\"\n[effects.parameters]\ninertia = 2.5\n";
        let table: toml::Table = with_load(saved, 0.5).unwrap().parse().unwrap();
        let stated = table["model"]["inertia"].as_float();
        let found = table["effects"][0]["parameters"]["inertia"].as_float();
        assert_eq!((stated, found), (Some(2.5), Some(3.0)), "{table}");
        assert_eq!(with_load("title = 3", 0.5), None);
    }
}
