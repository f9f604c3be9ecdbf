//! `paddle gap blind`: scores the diagnosis on recordings whose true effects it does not know.

mod board;
mod hidden;

use super::own_effects;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::numbers;
use crate::targets::{Target, Use};
use blind::score::Summary;
use blind::{Check, Mixture, OwnEffect};
use board::BoardCheck;
use clap::Args;
use host_sim::effects::{self, EffectError};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of the check.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap blind --cases 200 --seed 1
  paddle gap blind --cases 100 --seed 2,3,4
  paddle gap blind --cases 20 --seed 7 --effect stribeck --withhold stribeck
  paddle gap blind --cases 20 --seed 7 --effect eddy-brake.toml
  paddle gap blind --cases 40 --seed 11 --messy --transfer
  paddle gap blind --cases 40 --seed 3 --generate-only --out recordings
  paddle gap blind --board --cases 20 --seed 5 --messy

Each case is a recording of a random device with something hidden in it, made by a simulation that shares nothing with
the one that the diagnosis fits. The diagnosis runs as a process of its own on the recording alone; the truth is opened
afterwards. Everything is kept in a folder a case: recording, diagnosis, model, truth, and a fresh recording of the same
device on which the claimed shrink is checked.

With --board each case is a virtual board whose paddle has something hidden in it, and `paddle experiment` against it.")]
pub struct Arguments {
    /// Number of cases.
    #[arg(long, default_value_t = 40, value_parser = numbers::count)]
    cases: u64,
    /// Seed of the set. A case depends only on the seed and on its number. Several seeds give several sets, which are scored
    /// together.
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = numbers::whole)]
    seed: Vec<u64>,
    /// Realistic devices: one dominant effect, three to five small effects, errors in the model's numbers, and timing
    /// errors.
    #[arg(long)]
    messy: bool,
    /// Evaluate the saved model on a second recording of the device, with another excitation, amplitude and load.
    #[arg(long)]
    transfer: bool,
    /// Hide only this effect in every case; with --messy, as the dominant effect. A file ending in .toml defines an effect of
    /// your own, see docs/own-effects.md, which is also added to the library of the diagnosis.
    #[arg(long, value_name = "NAME|FILE.toml")]
    effect: Option<String>,
    /// Remove this effect from the library of the diagnosis.
    #[arg(long, value_name = "NAME")]
    withhold: Option<String>,
    /// Folder of the cases, with a subfolder per seed if there are several seeds [default: paddle-out/blind-SEED].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of cases that run in parallel.
    #[arg(long, default_value_t = 1, value_parser = numbers::count)]
    jobs: u64,
    /// Longest time of a diagnosis; a longer one counts as failed.
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = numbers::count)]
    patience: u64,
    /// Write the recordings and the true effects, but diagnose nothing.
    #[arg(long)]
    generate_only: bool,
    /// Run experiments on virtual boards instead. With --messy each paddle has one dominant effect, three small ones, and
    /// errors of 5 % in the model's numbers.
    #[arg(long, conflicts_with_all = ["transfer", "withhold", "generate_only", "jobs", "patience"])]
    board: bool,
    /// Longest experiment time per paddle.
    #[arg(long, default_value_t = 180.0, value_name = "s", value_parser = numbers::positive, requires = "board")]
    seconds: f64,
}

/// Generates, diagnoses and scores the cases. Each finished case prints a line on standard error.
///
/// # Errors
/// Returns a [`Failure`] if a case cannot be generated or stored.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.check_names()?;
    if arguments.board {
        return arguments.boards();
    }
    let mut outcomes = Vec::new();
    let mut sets = Vec::new();
    let mut kept = String::new();
    let mut problems = Vec::new();
    let own = arguments.own_effect()?;
    let checks = arguments
        .seed
        .iter()
        .map(|&seed| arguments.check(seed, own.as_ref()));
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
            // The results of the earlier sets are kept.
            problems.push(failure.into());
            break;
        }
        kept += &format!("seed {seed}: everything in {}\n", check.folder.display());
        sets.push(json!({ "seed": seed, "cases": check.cases, "messy": arguments.messy, "folder": check.folder }));
    }
    if arguments.generate_only {
        return Ok(Answer {
            text: kept,
            json: json!({ "sets": sets }),
            problems,
        });
    }
    let summary = Summary::of(outcomes);
    Ok(Answer {
        text: format!("{summary}{kept}"),
        json: json!({ "sets": sets, "summary": summary, "commit": env!("PADDLE_COMMIT") }),
        problems,
    })
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("--out", Use::NewFolder, self.out.as_ref())
            .into_iter()
            .collect()
    }

    /// Checks the names of effects, and that no seed is given twice.
    fn check_names(&self) -> Result<(), Failure> {
        for name in self
            .withhold
            .as_deref()
            .into_iter()
            .chain(self.hidden_name())
        {
            effects::kind(name).ok_or_else(|| EffectError::Kind(name.to_owned()))?;
        }
        let mut seeds = self.seed.iter().enumerate();
        match seeds.find(|(at, seed)| self.seed[..*at].contains(seed)) {
            Some((_, seed)) => Err(Failure::Setting(format!(
                "--seed has {seed} twice; each set counts once"
            ))),
            None => Ok(()),
        }
    }

    /// The name of the only effect to hide, if it is one of the library.
    fn hidden_name(&self) -> Option<&str> {
        let name = self.effect.as_deref();
        name.filter(|_| self.own_effect_file().is_none())
    }

    /// The file of the only effect to hide, if it is one of the user.
    fn own_effect_file(&self) -> Option<&Path> {
        let path = self.effect.as_deref().map(Path::new);
        path.filter(|path| path.extension().is_some_and(|end| end == "toml"))
    }

    /// The effect of the user to hide in every case.
    fn own_effect(&self) -> Result<Option<OwnEffect>, Failure> {
        let Some(path) = self.own_effect_file() else {
            return Ok(None);
        };
        let text = own_effects::add(path)?;
        match OwnEffect::read(&text) {
            Ok(own) => Ok(Some(own)),
            Err(cause) => Err(Failure::Setting(format!("{}: {cause}", path.display()))),
        }
    }

    /// Runs the experiments on virtual boards for every set.
    fn boards(&self) -> Result<Answer, Failure> {
        if self.own_effect_file().is_some() {
            return Err(Failure::Setting(
                "--board hides effects of the library only; leave --board out, or give the name of an effect".into(),
            ));
        }
        let mut all = Answer::default();
        let (mut sets, mut findings) = (Vec::new(), Vec::new());
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
            let (answer, of_set) = check.run()?;
            let Answer {
                text,
                json,
                problems,
            } = answer;
            findings.extend(of_set);
            all.text += &format!("seed {seed}\n{text}");
            sets.push(json);
            all.problems.extend(problems);
        }
        let rows = board::rows(&findings, self.messy);
        all.json =
            json!({ "sets": sets, "summary": { "rows": rows }, "commit": env!("PADDLE_COMMIT") });
        Ok(all)
    }

    /// Folder of the set `seed`.
    fn folder(&self, seed: u64) -> PathBuf {
        match (&self.out, self.seed.len()) {
            (Some(out), 1) => out.clone(),
            (Some(out), _) => out.join(seed.to_string()),
            (None, _) => format!("paddle-out/blind-{seed}").into(),
        }
    }

    /// The check of the set `seed`.
    fn check(&self, seed: u64, own: Option<&OwnEffect>) -> Result<Check, Failure> {
        Ok(Check {
            program: std::env::current_exe().map_err(Failure::read("this program"))?,
            folder: self.folder(seed),
            cases: self.cases,
            seed,
            mixture: Mixture {
                only: self.hidden_name().map(str::to_owned),
                own: own.cloned(),
                messy: self.messy,
                transfer: self.transfer,
            },
            own_effect: self.own_effect_file().map(Path::to_owned),
            withheld: self.withhold.clone(),
            jobs: usize::try_from(self.jobs).unwrap_or(usize::MAX),
            patience: Duration::from_secs(self.patience),
        })
    }
}
