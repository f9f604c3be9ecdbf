//! `paddle experiment`: records experiments, diagnoses, and records what the diagnosis asks for.

mod exploration;

use super::gap::results;
use super::record::Nominal;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::numbers;
use crate::provenance::Provenance;
use crate::report::{self, Labels};
use crate::rig::{ROWS_HZ, Rig};
use crate::targets::{Target, Use};
use clap::Args;
use remote::Plan;
use std::path::PathBuf;

pub use exploration::{Found, explore, is_unique};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle experiment --port /dev/ttyUSB0 --out my-paddle
  paddle board --with stribeck:static_ratio=1.8       # in another terminal; it says which port
  paddle experiment --port /dev/pts/3 --out hidden

It ends when the diagnosis names what explains the gap and nothing else could be it, when there is no gap, or when the
time is over. The recording, the last diagnosis, its report and the corrected model stay in --out.")]
pub struct Arguments {
    /// Serial port of the board, or the terminal that `paddle board` prints.
    #[arg(long)]
    port: String,
    #[command(flatten)]
    how: How,
}

/// Options of the experiments and of their output.
#[derive(Args)]
pub struct How {
    /// First experiment, in place of a torque multisine and a slow position motion; may be repeated.
    #[arg(long = "run", value_name = "SHAPE:NUMBERS")]
    runs: Vec<Plan>,
    /// Longest total time of the experiments on the paddle.
    #[arg(long, default_value_t = 180.0, value_name = "s", value_parser = numbers::positive)]
    seconds: f64,
    /// Write the recording and the diagnosis to this folder.
    #[arg(long, default_value = "paddle-out/experiment", value_name = "DIR")]
    pub out: PathBuf,
    #[command(flatten)]
    nominal: Nominal,
    /// Rows per second.
    #[arg(long, default_value_t = ROWS_HZ, value_name = "Hz", value_parser = numbers::positive)]
    rate: f64,
}

/// Runs the experiments.
///
/// # Errors
/// Returns a [`Failure`] if the board refuses a command, if the recording cannot be used, or if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let interrupt = Interrupt::watched()?;
    let mut rig = Rig::open(&arguments.port)?;
    let found = explore(&mut rig, &arguments.how, &interrupt);
    let left = rig.leave();
    let mut answer = arguments.how.answer(found?)?;
    answer.problems.extend(left.err().map(Failure::from));
    Ok(answer)
}

impl Arguments {
    /// Creates arguments with the default values for all other options.
    pub fn on(port: String, out: PathBuf, seconds: f64) -> Self {
        let how = How::new(out, seconds);
        Self { port, how }
    }

    /// Paths that the command writes and reads.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let out = Target::of("--out", Use::Folder, &self.how.out);
        [self.how.nominal.target(), out]
            .into_iter()
            .flatten()
            .collect()
    }
}

impl How {
    /// Creates options with the default values for the rest.
    pub fn new(out: PathBuf, seconds: f64) -> Self {
        Self {
            runs: Vec::new(),
            seconds,
            out,
            nominal: Nominal::default(),
            rate: ROWS_HZ,
        }
    }

    /// Folder of the recording.
    pub fn recording(&self) -> PathBuf {
        self.out.join("recording")
    }

    /// Writes the diagnosis, its report and the corrected model to the folder of the recording.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the recording cannot be read back.
    pub fn answer(&self, found: Found) -> Result<Answer, Failure> {
        let Found {
            recording,
            outcome,
            told,
            mut problems,
            ..
        } = found;
        let folder = self.recording();
        let provenance = Provenance::of(&folder, &recording)?;
        let json = results::json(&recording, &outcome, &provenance);
        let mut text = format!(
            "{told}\n{}",
            report::text(&outcome.diagnosis, &Labels::of(&recording))
        );
        let mut say = |what: &str, path: PathBuf, saved: Result<(), Failure>| match saved {
            Ok(()) => text.push_str(&format!("{what} in {}\n", path.display())),
            Err(failure) => problems.push(failure),
        };
        let path = self.out.join("corrected.toml");
        let saved = results::save_model(&path, &recording, &outcome, false);
        say("corrected model", path, saved);
        let path = self.out.join("report.html");
        let saved = results::save_report(&path, &recording, &outcome, &provenance);
        say("report", path, saved);
        let path = self.out.join("diagnosis.json");
        let saved = std::fs::write(&path, format!("{json:#}\n")).map_err(Failure::write(&path));
        say("diagnosis", path, saved);
        say("recording", folder, Ok(()));
        Ok(Answer {
            text,
            json,
            problems,
        })
    }
}
