//! `paddle gap blind`: the diagnosis scored on recordings whose truth it does not see.

use crate::answer::Answer;
use crate::failure::Failure;
use blind::score::Summary;
use blind::{Check, Mixture};
use clap::Args;
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

Each case is a recording of a random device with something hidden in it, made by a simulation that shares nothing with
the one that the diagnosis fits. The diagnosis runs as a process of its own on the recording alone; the truth is opened
afterwards. Everything is kept in a folder a case: recording, diagnosis, model, truth, and a fresh recording of the same
device on which the claimed shrink is checked.")]
pub struct Arguments {
    /// How many cases.
    #[arg(long, default_value_t = 40)]
    cases: u64,
    /// Seed of the set; a case depends on it and its number alone. Several seeds make several sets, scored as one.
    #[arg(long, value_delimiter = ',', default_value = "1")]
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
    #[arg(long, default_value_t = 1)]
    jobs: usize,
    /// A diagnosis that takes longer has failed.
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    patience: u64,
    /// Leave recordings and truths, diagnose nothing.
    #[arg(long)]
    generate_only: bool,
}

/// Makes, diagnoses and scores; one line a case goes to standard error as it is done.
///
/// # Errors
/// [`Failure`] if a case cannot be made or kept.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let mut outcomes = Vec::new();
    let mut sets = Vec::new();
    let mut kept = String::new();
    for &seed in &arguments.seed {
        let check = arguments.check(seed)?;
        match arguments.generate_only {
            true => check.generate()?,
            false => outcomes.extend(check.run(|outcome| eprintln!("{outcome}"))?.outcomes),
        }
        kept += &format!("seed {seed}: everything in {}\n", check.folder.display());
        sets.push(json!({ "seed": seed, "cases": check.cases, "folder": check.folder }));
    }
    if arguments.generate_only {
        return Ok(Answer {
            text: kept,
            json: json!({ "sets": sets }),
            ..Answer::default()
        });
    }
    let summary = Summary::of(outcomes);
    Ok(Answer {
        text: format!("{summary}{kept}"),
        json: json!({ "sets": sets, "summary": summary }),
        ..Answer::default()
    })
}

impl Arguments {
    /// The check of the set `seed`.
    fn check(&self, seed: u64) -> Result<Check, Failure> {
        let folder = match (&self.out, self.seed.len()) {
            (Some(out), 1) => out.clone(),
            (Some(out), _) => out.join(seed.to_string()),
            (None, _) => format!("paddle-out/blind-{seed}").into(),
        };
        Ok(Check {
            program: std::env::current_exe().map_err(Failure::read("this program"))?,
            folder,
            cases: self.cases,
            seed,
            mixture: Mixture {
                only: self.effect.clone(),
                messy: self.messy,
                transfer: self.transfer,
            },
            withheld: self.withhold.clone(),
            jobs: self.jobs,
            patience: Duration::from_secs(self.patience),
        })
    }
}
