//! `paddle gap blind`: the diagnosis scored on recordings whose truth it does not see.

use crate::answer::Answer;
use crate::failure::Failure;
use blind::{Check, Mixture};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;

/// Which set, and where it is kept.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap blind --cases 200 --seed 1
  paddle gap blind --cases 20 --seed 7 --effect stribeck --withhold stribeck
  paddle gap blind --cases 40 --seed 3 --generate-only --out recordings

Each case is a recording of a random device with something hidden in it, made by a simulation that shares nothing with
the one that the diagnosis fits. The diagnosis runs as a process of its own on the recording alone; the truth is opened
afterwards. Everything is kept in a folder a case: recording, diagnosis, model, truth, and a fresh recording of the same
device on which the claimed shrink is checked.")]
pub struct Arguments {
    /// How many cases.
    #[arg(long, default_value_t = 40)]
    cases: u64,
    /// Seed of the set; a case depends on it and its number alone.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Hide this effect alone in every case.
    #[arg(long, value_name = "NAME")]
    effect: Option<String>,
    /// Take this effect out of the diagnosis's library.
    #[arg(long, value_name = "NAME")]
    withhold: Option<String>,
    /// Folder for the cases; paddle-out/blind-SEED if left out.
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
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| format!("paddle-out/blind-{}", arguments.seed).into());
    let check = Check {
        program: std::env::current_exe().map_err(Failure::read("this program"))?,
        folder,
        cases: arguments.cases,
        seed: arguments.seed,
        mixture: Mixture {
            only: arguments.effect.clone(),
        },
        withheld: arguments.withhold.clone(),
        jobs: arguments.jobs,
        patience: Duration::from_secs(arguments.patience),
    };
    let kept = format!("everything in {}\n", check.folder.display());
    let set = json!({ "seed": check.seed, "cases": check.cases, "folder": check.folder });
    if arguments.generate_only {
        check.generate()?;
        return Ok(Answer {
            text: kept,
            json: set,
            ..Answer::default()
        });
    }
    let summary = check.run(|outcome| eprintln!("{outcome}"))?;
    Ok(Answer {
        text: format!("seed {}\n{summary}{kept}", check.seed),
        json: json!({ "set": set, "summary": summary }),
        ..Answer::default()
    })
}
