//! The sequence of experiments: record, diagnose, and choose the next experiment.

use super::How;
use crate::commands::gap::{diagnose, usable};
use crate::commands::record;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress;
use crate::rig::Rig;
use gap::diagnosis::{Diagnosis, NextExperiment, Verdict};
use gap::{Outcome, Recording};
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, Shape};
use remote::{DeviceError, Plan, Recorder, Wire};

/// Experiments that are recorded by default. The first ones show most effects; the later ones are recorded when the
/// diagnosis asks for none.
const MENU: [&str; 7] = [
    "torque:multisine:0.0036,2,6",
    "position:triangle:20,0.25,8",
    "torque:multisine:0.0028,1,8",
    "position:multisine:15,0.5,8",
    "torque:chirp:0.004,1,8,8",
    "position:square:8,1,8",
    "torque:sine:0.002,1,8",
];
/// Number of these experiments that are recorded before the first diagnosis.
const FIRST: usize = 2;
/// Factor on the amplitude when an experiment that ended in a fault is repeated.
const SMALLER: f32 = 0.75;
const MOST_TRIALS: usize = 4;
/// Time to centre and arm the paddle, s.
const READY_S: f64 = 1.5;
/// Share of the gap that must be closed on held-out data, at the lower end of its interval. The rest is then below the
/// smallest share that the blind check counts as a cause ([`blind::SMALL_SHARE`]).
const CLOSED: f64 = 1.0 - blind::SMALL_SHARE[0];
/// Largest torque of an experiment, N m at the motor. It is slightly below the torque at which the firmware's clamp acts.
const MOST_NM: f32 = 0.03;

/// Result of the experiments.
pub struct Found {
    /// The recording with all runs.
    pub recording: Recording,
    /// The last diagnosis.
    pub outcome: Outcome,
    /// One line of text per diagnosis, with the result at that time.
    pub told: String,
    /// Failures that ended the experiments early.
    pub problems: Vec<Failure>,
}

/// Records and diagnoses alternately, as `how` says, until the answer is unique or the time is used up.
///
/// # Errors
/// Returns a [`Failure`] if the board refuses a command before the first diagnosis, and if the recording cannot be written
/// or used.
pub fn explore<W: Wire>(
    rig: &mut Rig<W>,
    how: &How,
    interrupt: &Interrupt,
) -> Result<Found, Failure> {
    let recorder = how.nominal.recorder(&rig.settings)?;
    let mut exploration = Exploration {
        how,
        interrupt,
        rig,
        recorder,
        spent_s: 0.0,
        tried: Vec::new(),
        told: String::new(),
    };
    exploration.run()
}

/// State of the experiments.
struct Exploration<'a, W: Wire> {
    how: &'a How,
    interrupt: &'a Interrupt,
    rig: &'a mut Rig<W>,
    recorder: Recorder,
    spent_s: f64,
    tried: Vec<Plan>,
    /// One line of text per diagnosis.
    told: String,
}

impl<W: Wire> Exploration<'_, W> {
    fn run(&mut self) -> Result<Found, Failure> {
        let mut plans = if self.how.runs.is_empty() {
            menu().take(FIRST).collect()
        } else {
            self.how.runs.clone()
        };
        let mut last: Option<Found> = None;
        loop {
            let mut problems = Vec::new();
            for plan in &plans {
                if let Err(failure) = self.record(plan) {
                    problems.push(failure);
                    break;
                }
            }
            let runs = self.recorder.recording().runs.len();
            if runs == 0 {
                return Err(problems.pop().unwrap_or(Failure::NothingRecorded));
            }
            // The result of the previous diagnosis stays valid.
            if let Some(found) = last.take_if(|found| found.recording.runs.len() == runs) {
                match self
                    .next(&found.outcome.diagnosis)
                    .filter(|_| problems.is_empty())
                {
                    Some(plan) => plans = vec![plan],
                    None => return Ok(Found { problems, ..found }),
                }
                last = Some(found);
                continue;
            }
            let folder = self.how.recording();
            record::leave(&self.recorder, self.rig, &folder)?;
            progress::within("diagnosis");
            let recording = usable::read(&folder)?;
            let outcome = gap::diagnose(&recording, &diagnose::options(&[])?);
            let line = summary(&outcome.diagnosis, recording.runs.len(), self.spent_s);
            progress::note(&line);
            self.told.push_str(&line);
            self.told.push('\n');
            let next = if is_unique(&outcome.diagnosis) || !problems.is_empty() {
                None
            } else {
                self.next(&outcome.diagnosis)
            };
            let found = Found {
                recording,
                outcome,
                told: self.told.clone(),
                problems,
            };
            match next {
                Some(plan) => plans = vec![plan],
                None => return Ok(found),
            }
            last = Some(found);
        }
    }

    /// Records an experiment. If a fault ends it, records it again with a smaller amplitude. The rows before the fault are
    /// kept if there are enough of them.
    fn record(&mut self, plan: &Plan) -> Result<(), Failure> {
        progress::within(&format!("run {}", self.recorder.recording().runs.len() + 1));
        self.tried.push(plan.clone());
        let mut plan = plan.clone();
        for trial in 1.. {
            let begun_s = self.rig.device.time_s();
            let taken = self.rig.take(&plan, self.how.rate, self.interrupt);
            self.spent_s += self.rig.device.time_s() - begun_s;
            let (fault, kept) = match taken {
                Ok(taken) if !taken.moves() => {
                    progress::note(&format!("{plan}: the paddle did not move; left out"));
                    return Ok(());
                }
                Ok(taken) => {
                    self.recorder.add(&taken);
                    match taken.fault {
                        Some(fault) => (fault, "kept up to then"),
                        None => return Ok(()),
                    }
                }
                Err(DeviceError::Fault(fault)) => (fault, "too short to keep"),
                Err(other) => return Err(other.into()),
            };
            // Another experiment may still succeed.
            if trial == MOST_TRIALS {
                progress::note(&format!("{plan}: {fault}; {kept}"));
                return Ok(());
            }
            progress::note(&format!("{plan}: {fault}; {kept}; once more, smaller"));
            plan = plan.scaled(SMALLER);
        }
        Ok(())
    }

    /// Returns the next experiment: the one that the diagnosis asks for, or else a new one from the menu. Returns `None` if
    /// there is no time.
    fn next(&self, diagnosis: &Diagnosis) -> Option<Plan> {
        let asked = diagnosis.next_experiment.as_ref().and_then(plan_of);
        let mut open = asked
            .into_iter()
            .chain(menu())
            .filter(|plan| !self.tried.contains(plan));
        open.find(|plan| self.spent_s + READY_S + plan.whole_s() <= self.how.seconds)
    }
}

fn menu() -> impl Iterator<Item = Plan> {
    MENU.iter().filter_map(|text| text.parse().ok())
}

/// Whether the diagnosis is unique. Either the gap is explained, or the named effects close so much of it that the rest
/// needs no name. No other effect may explain the gap as well.
pub fn is_unique(diagnosis: &Diagnosis) -> bool {
    let alone = diagnosis
        .effects
        .iter()
        .all(|effect| effect.not_separable_from.is_empty());
    match diagnosis.verdict {
        Verdict::NoGap => true,
        Verdict::Explained => alone,
        Verdict::PartlyExplained => alone && diagnosis.gap.shrink_interval[0] >= CLOSED,
        Verdict::Unexplained => false,
    }
}

/// Converts the diagnosis's next experiment, which is a torque excitation, to a plan.
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

/// Summarises the diagnosis in one line.
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
