//! The course of experiments: record, diagnose, choose what to record next.

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
/// Until the paddle stands in the middle and is armed, s.
const READY_S: f64 = 1.5;
/// Share of the gap that must be closed on held-out data, at the lower end of its interval. What is left then is below the
/// smallest share of the gap that the blind check counts as a cause ([`blind::SMALL_SHARE`]).
const CLOSED: f64 = 1.0 - blind::SMALL_SHARE[0];
/// Torque beyond which the clamp of the firmware acts, N m at the motor, with a little to spare.
const MOST_NM: f32 = 0.03;

/// What the experiments came to.
pub struct Found {
    /// All runs.
    pub recording: Recording,
    /// The diagnosis of them.
    pub outcome: Outcome,
    /// What was known after each diagnosis, a line each.
    pub told: String,
    /// What ended them too soon.
    pub amiss: Vec<Failure>,
}

/// Records and diagnoses by turns, as `how` says, until the answer is unique or the time is over.
///
/// # Errors
/// [`Failure`] for a board that does not do as it is asked before there is a diagnosis, and for a recording that cannot be
/// written or used.
pub fn explore<W: Wire>(
    rig: &mut Rig<W>,
    how: &How,
    interrupt: &Interrupt,
) -> Result<Found, Failure> {
    let recorder = how.nominal.recorder(&rig.settings)?;
    let mut course = Course {
        how,
        interrupt,
        rig,
        recorder,
        spent_s: 0.0,
        tried: Vec::new(),
        told: String::new(),
    };
    course.run()
}

/// The experiments so far.
struct Course<'a, W: Wire> {
    how: &'a How,
    interrupt: &'a Interrupt,
    rig: &'a mut Rig<W>,
    recorder: Recorder,
    spent_s: f64,
    tried: Vec<Plan>,
    /// A line on each diagnosis.
    told: String,
}

impl<W: Wire> Course<'_, W> {
    fn run(&mut self) -> Result<Found, Failure> {
        let mut plans = if self.how.runs.is_empty() {
            menu().take(FIRST).collect()
        } else {
            self.how.runs.clone()
        };
        let mut last: Option<Found> = None;
        loop {
            let mut amiss = Vec::new();
            for plan in &plans {
                if let Err(failure) = self.record(plan) {
                    amiss.push(failure);
                    break;
                }
            }
            let runs = self.recorder.recording().runs.len();
            if runs == 0 {
                return Err(amiss.pop().unwrap_or(Failure::Fault));
            }
            // What was diagnosed before stands.
            if let Some(found) = last.take_if(|found| found.recording.runs.len() == runs) {
                match self
                    .next(&found.outcome.diagnosis)
                    .filter(|_| amiss.is_empty())
                {
                    Some(plan) => plans = vec![plan],
                    None => return Ok(Found { amiss, ..found }),
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
            let next = if is_unique(&outcome.diagnosis) || !amiss.is_empty() {
                None
            } else {
                self.next(&outcome.diagnosis)
            };
            let found = Found {
                recording,
                outcome,
                told: self.told.clone(),
                amiss,
            };
            match next {
                Some(plan) => plans = vec![plan],
                None => return Ok(found),
            }
            last = Some(found);
        }
    }

    /// Records an experiment, and once more with a smaller signal if a fault ends it. What was recorded before the fault is
    /// kept if it is long enough.
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
            // Other experiments may still say something.
            if trial == MOST_TRIALS {
                progress::note(&format!("{plan}: {fault}; {kept}"));
                return Ok(());
            }
            progress::note(&format!("{plan}: {fault}; {kept}; once more, smaller"));
            plan = plan.scaled(SMALLER);
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
        open.find(|plan| self.spent_s + READY_S + plan.whole_s() <= self.how.seconds)
    }
}

fn menu() -> impl Iterator<Item = Plan> {
    MENU.iter().filter_map(|text| text.parse().ok())
}

/// Whether nothing is left to be told apart: the gap is explained, or what is named closes so much of it that what may be
/// left has no name, and nothing else could be it.
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
