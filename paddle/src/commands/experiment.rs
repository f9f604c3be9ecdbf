//! `paddle experiment`: record, diagnose, and record what the diagnosis asks for.

use super::gap::{diagnose, results, usable};
use super::record::{self, Nominal};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::numbers;
use crate::progress;
use crate::provenance::Provenance;
use crate::report::{self, Labels};
use crate::rig::{ROWS_HZ, Rig};
use crate::targets::{Target, Use};
use clap::Args;
use gap::diagnosis::{Diagnosis, NextExperiment, Verdict};
use gap::{Outcome, Recording};
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, Shape};
use remote::{DeviceError, Plan, Recorder, Taken};
use std::path::PathBuf;

/// Which board, and for how long.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle experiment --port /dev/ttyUSB0 --out my-paddle
  paddle board --with stribeck:static_ratio=1.8        in another terminal; it says which port
  paddle experiment --port /dev/pts/3 --out hidden

It ends when the diagnosis names what explains the gap and nothing else could be it, when there is no gap, or when the
time is over. The recording, the last diagnosis, its report and the corrected model stay in --out.")]
pub struct Arguments {
    /// The serial port, or what `paddle board` says.
    #[arg(long)]
    port: String,
    /// Begin with these instead of a multisine of the torque and slow motion of the position; may be repeated.
    #[arg(long = "run", value_name = "SHAPE:NUMBERS")]
    runs: Vec<Plan>,
    /// Most time of the paddle's.
    #[arg(long, default_value_t = 180.0, value_name = "s", value_parser = numbers::positive)]
    seconds: f64,
    /// Leave recording and diagnosis in this folder.
    #[arg(long, default_value = "paddle-out/experiment", value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    nominal: Nominal,
    /// Rows a second.
    #[arg(long, default_value_t = ROWS_HZ, value_name = "Hz", value_parser = numbers::positive)]
    rate: f64,
}

/// What is recorded where nothing else is asked for: first what shows most effects, then what the diagnosis did not ask
/// for.
const MENU: [&str; 7] = [
    "torque:multisine:0.0036,2,6",
    "position:triangle:20,0.25,8",
    "torque:multisine:0.0028,1,8",
    "position:multisine:15,0.5,8",
    "torque:chirp:0.004,1,8,8",
    "position:square:8,1,8",
    "torque:sine:0.002,1,8",
];
/// So many of them are recorded before the first diagnosis.
const FIRST: usize = 2;
/// A signal that drove the paddle into a fault is tried again, smaller by this.
const SMALLER: f32 = 0.75;
const MOST_TRIALS: usize = 4;
/// Torque beyond which the clamp of the firmware acts, N m at the motor, with a little to spare.
const MOST_NM: f32 = 0.03;

/// Experiments.
///
/// # Errors
/// [`Failure`] for a board that does not do as it is asked, a recording that cannot be used, and files that cannot be
/// written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let interrupt = Interrupt::watched()?;
    let mut rig = Rig::open(&arguments.port)?;
    let recorder = arguments.nominal.recorder(&rig)?;
    let mut course = Course {
        arguments,
        interrupt: &interrupt,
        rig: &mut rig,
        recorder,
        spent_s: 0.0,
        tried: Vec::new(),
    };
    let found = course.run();
    let left = rig.leave();
    let mut answer = found?;
    answer.amiss.extend(left.err().map(Failure::from));
    Ok(answer)
}

impl Arguments {
    /// With what else there is by default.
    pub fn on(port: String, out: PathBuf, seconds: f64) -> Self {
        Self {
            port,
            runs: Vec::new(),
            seconds,
            out,
            nominal: Nominal::default(),
            rate: ROWS_HZ,
        }
    }

    /// Where it will write, and what it reads.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let out = Target::of("--out", Use::Folder, &self.out);
        [self.nominal.target(), out].into_iter().flatten().collect()
    }

    fn recording(&self) -> PathBuf {
        self.out.join("recording")
    }
}

/// The experiments so far.
struct Course<'a> {
    arguments: &'a Arguments,
    interrupt: &'a Interrupt,
    rig: &'a mut Rig,
    recorder: Recorder,
    spent_s: f64,
    tried: Vec<Plan>,
}

impl Course<'_> {
    fn run(&mut self) -> Result<Answer, Failure> {
        let mut plans = if self.arguments.runs.is_empty() {
            menu().take(FIRST).collect()
        } else {
            self.arguments.runs.clone()
        };
        let mut told = String::new();
        let mut amiss = Vec::new();
        let mut last = None;
        loop {
            for plan in &plans {
                if let Err(failure) = self.record(plan) {
                    amiss.push(failure);
                    break;
                }
            }
            // What was diagnosed before stands.
            if let (false, Some((recording, outcome))) = (amiss.is_empty(), &last) {
                return self.conclude(recording, outcome, told, amiss);
            }
            if self.recorder.recording().runs.is_empty() {
                return Err(amiss.pop().unwrap_or(Failure::Fault));
            }
            let folder = self.arguments.recording();
            record::leave(&self.recorder, self.rig, &folder)?;
            progress::within("diagnosis");
            let recording = usable::read(&folder)?;
            let outcome = gap::diagnose(&recording, &diagnose::options(&[])?);
            let line = summary(
                &outcome.diagnosis,
                self.recorder.recording().runs.len(),
                self.spent_s,
            );
            progress::note(&line);
            told.push_str(&line);
            told.push('\n');
            let next = if is_unique(&outcome.diagnosis) || !amiss.is_empty() {
                None
            } else {
                self.next(&outcome.diagnosis)
            };
            match next {
                Some(plan) => plans = vec![plan],
                None => return self.conclude(&recording, &outcome, told, amiss),
            }
            last = Some((recording, outcome));
        }
    }

    /// Records one, smaller if it drives the paddle too far.
    fn record(&mut self, plan: &Plan) -> Result<(), Failure> {
        progress::within(&format!("run {}", self.recorder.recording().runs.len() + 1));
        self.tried.push(plan.clone());
        let mut plan = plan.clone();
        for trial in 1.. {
            self.spent_s += plan.whole_s();
            match self.rig.take(&plan, self.arguments.rate, self.interrupt) {
                Ok(Taken {
                    fault: Some(fault), ..
                })
                | Err(DeviceError::Fault(fault))
                    if trial < MOST_TRIALS =>
                {
                    progress::note(&format!("{plan}: {fault}; once more, smaller"));
                    plan = plan.scaled(SMALLER);
                }
                Ok(taken) => {
                    self.recorder.add(&taken);
                    return Ok(());
                }
                // Others may still say something.
                Err(DeviceError::Fault(fault)) => {
                    progress::note(&format!("{plan}: {fault}; left out"));
                    return Ok(());
                }
                Err(other) => return Err(other.into()),
            }
        }
        Ok(())
    }

    /// What to record next: what the diagnosis asks for, or else something new, if there is time.
    fn next(&self, diagnosis: &Diagnosis) -> Option<Plan> {
        let asked = diagnosis.next_experiment.as_ref().and_then(plan_of);
        let mut open = asked
            .into_iter()
            .chain(menu())
            .filter(|plan| !self.tried.contains(plan));
        open.find(|plan| self.spent_s + plan.whole_s() <= self.arguments.seconds)
    }

    fn conclude(
        &self,
        recording: &Recording,
        outcome: &Outcome,
        told: String,
        mut amiss: Vec<Failure>,
    ) -> Result<Answer, Failure> {
        let folder = self.arguments.recording();
        let out = &self.arguments.out;
        let provenance = Provenance::of(&folder, recording)?;
        let json = results::json(recording, outcome, &provenance);
        let mut text = format!(
            "{told}\n{}",
            report::text(&outcome.diagnosis, &Labels::of(recording))
        );
        let mut say = |what: &str, path: PathBuf, saved: Result<(), Failure>| match saved {
            Ok(()) => text.push_str(&format!("{what} in {}\n", path.display())),
            Err(failure) => amiss.push(failure),
        };
        let path = out.join("corrected.toml");
        let saved = results::save_model(&path, recording, outcome, false);
        say("corrected model", path, saved);
        let path = out.join("report.html");
        let saved = results::save_report(&path, recording, outcome, &provenance);
        say("report", path, saved);
        let path = out.join("diagnosis.json");
        let saved = std::fs::write(&path, format!("{json:#}\n")).map_err(Failure::write(&path));
        say("diagnosis", path, saved);
        say("recording", folder, Ok(()));
        Ok(Answer { text, json, amiss })
    }
}

fn menu() -> impl Iterator<Item = Plan> {
    MENU.iter().filter_map(|text| text.parse().ok())
}

/// Whether nothing is left to be told apart.
fn is_unique(diagnosis: &Diagnosis) -> bool {
    match diagnosis.verdict {
        Verdict::NoGap => true,
        Verdict::Explained => diagnosis
            .effects
            .iter()
            .all(|effect| effect.not_separable_from.is_empty()),
        _ => false,
    }
}

/// The diagnosis's next experiment, which is of the torque.
fn plan_of(next: &NextExperiment) -> Option<Plan> {
    let (_, shape) = Shape::NAMED.iter().find(|(name, _)| *name == next.kind)?;
    let number = |name: &str| next.settings.get(name).map(|number| *number as f32);
    let duration_s = number("duration").or(number("duration_s")).unwrap_or(6.0);
    Some(Plan {
        mode: Mode::Torque,
        excitation: Excitation {
            shape: *shape,
            frequency_hz: number("frequency_hz").unwrap_or(0.0),
            end_frequency_hz: number("end_frequency_hz").unwrap_or(0.0),
            duration_s,
            ..Excitation::step(number("amplitude")?.clamp(-MOST_NM, MOST_NM))
        },
    })
}

/// A line on what is known so far.
fn summary(diagnosis: &Diagnosis, runs: usize, spent_s: f64) -> String {
    let effects: Vec<_> = diagnosis
        .effects
        .iter()
        .map(|effect| {
            let rivals = if effect.not_separable_from.is_empty() {
                String::new()
            } else {
                format!(" (or {})", effect.not_separable_from.join(", "))
            };
            format!("{}{rivals}", effect.name)
        })
        .collect();
    let effects = if effects.is_empty() {
        match diagnosis.verdict {
            Verdict::NoGap => "no gap".to_owned(),
            _ => "nothing named yet".to_owned(),
        }
    } else {
        effects.join(" and ")
    };
    format!("after {runs} runs, {spent_s:.0} s: {effects}")
}
