//! The whole check: make a case, have it diagnosed by another process, open the truth, score.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::case::{Case, CaseError, Mixture};
use crate::diagnosis::{Diagnosis, Gap};
use crate::score::{FreshGaps, Outcome, Summary, judge};

/// What is checked, and where everything is kept.
#[derive(Clone, Debug)]
pub struct Check {
    /// The program that has `gap diagnose` and `gap measure`.
    pub program: PathBuf,
    /// Folder for all cases; must not exist or be empty.
    pub folder: PathBuf,
    /// How many cases.
    pub cases: u64,
    /// Seed of the set.
    pub seed: u64,
    /// What is drawn.
    pub mixture: Mixture,
    /// Effect to take out of the diagnosis's library.
    pub withheld: Option<String>,
    /// How many cases at once.
    pub jobs: usize,
    /// A diagnosis that takes longer than this has failed.
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
    /// The results of another check would be mixed with these.
    #[error("{} is not empty; name another folder", .0.display())]
    NotEmpty(PathBuf),
    /// A file could not be written.
    #[error("cannot write {}: {source}; name another place", .path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The program could not be started.
    #[error("cannot run {}: {source}; name a program that can be run", .path.display())]
    Program {
        /// The program.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Check {
    /// Makes and scores all cases, and gives each outcome to `told` as soon as it is there.
    ///
    /// # Errors
    /// [`CheckError`]; a diagnosis that fails is no error but a wrong answer.
    pub fn run(&self, told: impl Fn(&Outcome) + Sync) -> Result<Summary, CheckError> {
        let mut outcomes = self.each(|number| {
            let outcome = self.score_case(number)?;
            told(&outcome);
            Ok(outcome)
        })?;
        outcomes.sort_by_key(|outcome| outcome.case);
        Ok(Summary::of(outcomes))
    }

    /// Makes all cases with their truths beside them, and diagnoses none.
    ///
    /// # Errors
    /// [`CheckError`].
    pub fn generate(&self) -> Result<(), CheckError> {
        self.each(|number| {
            let case = Case::make(self.seed, number, &self.mixture)?;
            let folder = self.case_folder(number);
            case.recording.write(folder.join(RECORDING))?;
            unseal(&case, &folder)
        })
        .map(|_| ())
    }

    /// Makes sure that the folder is free.
    ///
    /// # Errors
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
                            // Nobody starts another case.
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
        unseal(&case, &folder)?;
        let fresh = match &diagnosis {
            Some(found)
                if case.truth.fresh_floor.is_some()
                    && !found.effects.is_empty()
                    && model.exists() =>
            {
                self.measure_fresh(&folder.join(FRESH), &model)?
            }
            _ => None,
        };
        let withheld = self.withheld.as_deref();
        let mut outcome = judge(&case.truth, diagnosis.as_ref(), fresh, withheld);
        // One that failed says nothing of its time, and must not pass for quick.
        outcome.elapsed_s.get_or_insert(took_s);
        Ok(outcome)
    }

    /// `None` if the program fails or says something else than the contract has it say.
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
                // It may have ended this very moment, which is as good.
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

    fn measure_fresh(&self, fresh: &Path, model: &Path) -> Result<Option<FreshGaps>, CheckError> {
        let base = [
            "gap".into(),
            "measure".into(),
            fresh.as_os_str().to_owned(),
            "--json".into(),
            "-".into(),
        ];
        let nominal = self.measured(&base)?;
        let with_model: Vec<_> = base
            .into_iter()
            .chain(["--model".into(), model.as_os_str().to_owned()])
            .collect();
        let corrected = self.measured(&with_model)?;
        Ok(nominal
            .zip(corrected)
            .map(|(nominal, corrected)| FreshGaps {
                nominal: nominal.before,
                corrected: corrected.before,
            }))
    }

    fn measured(&self, words: &[std::ffi::OsString]) -> Result<Option<Gap>, CheckError> {
        #[derive(serde::Deserialize)]
        struct Measured {
            gap: Gap,
        }
        let output = self.program(words)?;
        Ok(serde_json::from_slice(&output.stdout)
            .ok()
            .map(|measured: Measured| measured.gap))
    }

    fn program(&self, words: &[std::ffi::OsString]) -> Result<std::process::Output, CheckError> {
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

/// How often a running diagnosis is looked at: its own clock says how long it took.
const POLL: Duration = Duration::from_millis(10);
const RECORDING: &str = "recording";
const FRESH: &str = "fresh";

/// Writes what the diagnosis must not have seen.
fn unseal(case: &Case, folder: &Path) -> Result<(), CheckError> {
    case.fresh.write(folder.join(FRESH))?;
    let path = folder.join("truth.json");
    let text = format!("{:#}\n", serde_json::json!(case.truth));
    fs::write(&path, text).map_err(|source| CheckError::Write { path, source })
}
