//! Simulates a device with its plans and measures the prediction errors against the truth.

use recording::{Model, Recording, Tolerance};

use super::FINE_STEPS;
use super::secret::Secret;
use super::timing::WrongTimes;
use crate::draw::Draw;
use crate::prediction::{self, HiddenStates, Restart};
use crate::reality::Reality;
use crate::scenario::{Plan, Plant, Scale};
use crate::session::{self, Log, Logging, SECOND_COLUMN};
use crate::truth::{Effect, Reference};

/// A motion is rejected if its half span exceeds the expected one by more than this factor.
const SPAN_CHANGE: f64 = 4.0;
/// Simulation steps of a prediction per period of the motion.
const PREDICTION_STEPS: f64 = 20_000.0;

/// A device and how it is logged, modelled and predicted. Causes are then hidden in it.
pub(super) struct Bench {
    pub(super) plant: Plant,
    pub(super) nominal: Model,
    pub(super) tolerance: Tolerance,
    pub(super) logging: Logging,
    pub(super) restart: Restart,
    /// If true, the time column starts at zero in every run. Otherwise all runs share one clock.
    pub(super) per_run_clocks: bool,
}

/// The logs of one session and their reference gaps.
pub(super) struct Measured {
    pub(super) logs: Vec<Log>,
    pub(super) reference: Reference,
}

impl Bench {
    pub(super) fn prediction_step_s(&self, reality: &Reality) -> f64 {
        // A compliant transmission is the stiffest part and needs finer steps.
        let steps = match reality.mechanics.coupling {
            Some(_) => FINE_STEPS,
            None => PREDICTION_STEPS,
        };
        1.0 / (steps * self.plant.motion_hz)
    }

    pub(super) fn plain(&self) -> Reality {
        Reality::plain(&self.plant.model)
    }

    /// Simulates `plans` on `reality` and measures the gaps. Returns `None` if the motion is not finite, too small or too
    /// large.
    pub(super) fn measure(
        &self,
        reality: &Reality,
        plans: &[Plan],
        scale: &Scale,
    ) -> Option<Measured> {
        let logs = session::carry_out(reality, plans, &self.logging);
        let sensible = logs.iter().all(|log| {
            let (low, high) = session::extremes(&log.position);
            let half = 0.5 * (high - low);
            half.is_finite()
                && half < SPAN_CHANGE * scale.half_span
                && half > 20.0 * self.plant.sensor.resolution.max(self.plant.sensor.noise)
                && low.abs().max(high.abs()) < 4.0 * SPAN_CHANGE * scale.half_span
        });
        if !sensible {
            return None;
        }
        let predict = |model: &Reality, hidden| {
            let step_s = self.prediction_step_s(model);
            prediction::predict(model, &logs, self.restart, hidden, step_s)
        };
        let plain = predict(&self.plain(), HiddenStates::Carried);
        let nominal = predict(&Reality::plain(&self.nominal), HiddenStates::Carried);
        let true_model = predict(reality, HiddenStates::Known);
        let reference = Reference {
            before: prediction::gap(&logs, &nominal),
            after: prediction::gap(&logs, &true_model),
            hidden_alone: prediction::gap(&logs, &plain),
            tolerances_alone: prediction::difference(&nominal, &plain),
        };
        reference
            .before
            .is_finite()
            .then_some(Measured { logs, reference })
    }

    /// The truth about `secret`. Its times are in the clock of the recording's time column.
    pub(super) fn describe(&self, secret: &Secret, scale: &Scale) -> Effect {
        let mut effect = secret.describe(scale);
        for place in &mut effect.places {
            if let (true, "time", Some(run)) = (self.per_run_clocks, place.axis.as_str(), place.run)
            {
                let origin = scale.runs_s[run][0];
                for end in [&mut place.from, &mut place.to] {
                    *end = end.map(|time_s| time_s - origin);
                }
            }
        }
        effect
    }

    /// The recording of `plans` by a logger whose times have the errors `times`.
    pub(super) fn recording_with_timing(
        &self,
        plans: &[Plan],
        logs: &[Log],
        times: WrongTimes,
        draw: &mut Draw,
    ) -> Recording {
        let mut recording = self.recording(plans, &times.apply_all(logs, draw));
        let row_s = self.plant.tick_s * self.plant.ticks_per_row as f64;
        times.state(&mut recording, row_s);
        recording
    }

    pub(super) fn recording(&self, plans: &[Plan], logs: &[Log]) -> Recording {
        let mut recording = Recording::new("A device", self.plant.horizon_s, self.nominal);
        recording.restart_half_width = self.restart.half_width_s;
        recording.units = self.plant.units.clone();
        recording.tolerance = self.tolerance.clone();
        recording
            .sensors
            .insert("position".into(), self.plant.sensor);
        if let Some(second) = self.logging.second {
            recording.sensors.insert(SECOND_COLUMN.into(), second);
        }
        recording.runs = plans
            .iter()
            .zip(logs)
            .enumerate()
            .map(|(k, (plan, log))| {
                log.run(plan, &format!("run-{}.csv", k + 1), self.per_run_clocks)
            })
            .collect();
        recording
    }
}
