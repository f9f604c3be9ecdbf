//! `paddle gap blind`: the diagnosis scored on recordings whose truth it does not see.

mod board;
mod hidden;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::numbers;
use crate::targets::{Target, Use};
use blind::score::Summary;
use blind::{Check, Mixture};
use board::BoardCheck;
use clap::Args;
use host_sim::effects::{self, EffectError};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;

/// Which set, and where it is kept.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap blind --cases 200 --seed 1
  paddle gap blind --cases 100 --seed 2,3,4
  paddle gap blind --cases 20 --seed 7 --effect stribeck --withhold stribeck
  paddle gap blind --cases 40 --seed 11 --messy --transfer
  paddle gap blind --cases 40 --seed 3 --generate-only --out recordings
  paddle gap blind --board --cases 20 --seed 5 --messy

Each case is a recording of a random device with something hidden in it, made by a simulation that shares nothing with
the one that the diagnosis fits. The diagnosis runs as a process of its own on the recording alone; the truth is opened
afterwards. Everything is kept in a folder a case: recording, diagnosis, model, truth, and a fresh recording of the same
device on which the claimed shrink is checked.

With --board each case is a virtual board whose paddle has something hidden in it, and `paddle experiment` against it.")]
pub struct Arguments {
    /// How many cases.
    #[arg(long, default_value_t = 40, value_parser = numbers::count)]
    cases: u64,
    /// Seed of the set; a case depends on it and its number alone. Several seeds make several sets, scored as one.
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = numbers::whole)]
    seed: Vec<u64>,
    /// Devices as real ones are: one dominant cause, three to five small ones, numbers that are off, wrong times.
    #[arg(long)]
    messy: bool,
    /// Judge the saved model on another recording of the device, with another excitation, amplitude and load.
    #[arg(long)]
    transfer: bool,
    /// Hide this effect alone in every case; with --messy, as the dominant cause.
    #[arg(long, value_name = "NAME")]
    effect: Option<String>,
    /// Take this effect out of the diagnosis's library.
    #[arg(long, value_name = "NAME")]
    withhold: Option<String>,
    /// Folder for the cases, with one for each seed in it if there are several; paddle-out/blind-SEED if left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How many cases at once.
    #[arg(long, default_value_t = 1, value_parser = numbers::count)]
    jobs: u64,
    /// A diagnosis that takes longer has failed.
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = numbers::count)]
    patience: u64,
    /// Write recordings and truths only; diagnose nothing.
    #[arg(long)]
    generate_only: bool,
    /// Experiment with virtual boards instead; with --messy each paddle has one dominant effect, three small ones, and
    /// numbers that are 5 % off.
    #[arg(long, conflicts_with_all = ["transfer", "withhold", "generate_only", "jobs", "patience"])]
    board: bool,
    /// Most time of each paddle's.
    #[arg(long, default_value_t = 180.0, value_name = "s", value_parser = numbers::positive, requires = "board")]
    seconds: f64,
}

/// Makes, diagnoses and scores; one line a case goes to standard error as it is done.
///
/// # Errors
/// [`Failure`] if a case cannot be made or kept.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.check_names()?;
    if arguments.board {
        return arguments.boards();
    }
    let mut outcomes = Vec::new();
    let mut sets = Vec::new();
    let mut kept = String::new();
    let mut amiss = Vec::new();
    let checks = arguments.seed.iter().map(|&seed| arguments.check(seed));
    let checks: Vec<Check> = checks.collect::<Result<_, _>>()?;
    for check in &checks {
        check.ready()?;
    }
    for check in checks {
        let seed = check.seed;
        let done = match arguments.generate_only {
            true => check.generate(),
            false => check
                .run(|outcome| eprintln!("{outcome}"))
                .map(|set| outcomes.extend(set.outcomes)),
        };
        if let Err(failure) = done {
            // The sets before this one are done.
            amiss.push(failure.into());
            break;
        }
        kept += &format!("seed {seed}: everything in {}\n", check.folder.display());
        sets.push(json!({ "seed": seed, "cases": check.cases, "messy": arguments.messy, "folder": check.folder }));
    }
    if arguments.generate_only {
        return Ok(Answer {
            text: kept,
            json: json!({ "sets": sets }),
            amiss,
        });
    }
    let summary = Summary::of(outcomes);
    Ok(Answer {
        text: format!("{summary}{kept}"),
        json: json!({ "sets": sets, "summary": summary, "commit": env!("PADDLE_COMMIT") }),
        amiss,
    })
}

impl Arguments {
    /// Where it will write.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("--out", Use::NewFolder, self.out.as_ref())
            .into_iter()
            .collect()
    }

    /// Makes sure that effects have names and that no set is scored twice.
    fn check_names(&self) -> Result<(), Failure> {
        for name in self.withhold.iter().chain(&self.effect) {
            effects::kind(name).ok_or_else(|| EffectError::Kind(name.clone()))?;
        }
        let mut seeds = self.seed.iter().enumerate();
        match seeds.find(|(at, seed)| self.seed[..*at].contains(seed)) {
            Some((_, seed)) => Err(Failure::Setting(format!(
                "--seed has {seed} twice; each set counts once"
            ))),
            None => Ok(()),
        }
    }

    /// Experiments with virtual boards, set by set.
    fn boards(&self) -> Result<Answer, Failure> {
        let mut all = Answer::default();
        let mut sets = Vec::new();
        for &seed in &self.seed {
            let folder = self.folder(seed);
            let check = BoardCheck {
                cases: self.cases,
                seed,
                only: self.effect.as_deref(),
                messy: self.messy,
                seconds: self.seconds,
                folder: &folder,
            };
            let Answer { text, json, amiss } = check.run()?;
            all.text += &format!("seed {seed}\n{text}");
            sets.push(json);
            all.amiss.extend(amiss);
        }
        all.json = json!({ "sets": sets });
        Ok(all)
    }

    /// Where the set `seed` is kept.
    fn folder(&self, seed: u64) -> PathBuf {
        match (&self.out, self.seed.len()) {
            (Some(out), 1) => out.clone(),
            (Some(out), _) => out.join(seed.to_string()),
            (None, _) => format!("paddle-out/blind-{seed}").into(),
        }
    }

    /// The check of the set `seed`.
    fn check(&self, seed: u64) -> Result<Check, Failure> {
        Ok(Check {
            program: std::env::current_exe().map_err(Failure::read("this program"))?,
            folder: self.folder(seed),
            cases: self.cases,
            seed,
            mixture: Mixture {
                only: self.effect.clone(),
                messy: self.messy,
                transfer: self.transfer,
            },
            withheld: self.withhold.clone(),
            jobs: usize::try_from(self.jobs).unwrap_or(usize::MAX),
            patience: Duration::from_secs(self.patience),
        })
    }
}
