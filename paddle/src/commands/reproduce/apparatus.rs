//! The paddle and board of all closed-loop rows.

use crate::failure::Failure;
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::metrics::StepReport;
use haptic_paddle::settings::{PidSettings, Sensor, Settings};
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::effects::Effect;
use host_sim::experiment::{Experiment, ExperimentError};
use host_sim::presets;

/// The refitted paddle on the lab's board, with the added effects.
#[derive(Clone, Debug)]
pub struct Apparatus {
    /// Effects, in the order in which they are added.
    pub with: Vec<Effect>,
}

/// A position step to 10°, as in the lab.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Sensor that feeds the regulator.
    pub sensor: Sensor,
    /// Proportional, integral and derivative gain: N m per degree, N m per degree and second, and N m s per degree, at the
    /// paddle.
    pub gains: [f32; 3],
    /// Sensor reading at rest before the step, degrees.
    pub start_deg: f64,
    /// Duration after the step, s.
    pub seconds: f64,
}

/// Response to a step.
#[derive(Clone, Debug)]
pub struct Response {
    /// Time since the step on the board's clock, s.
    pub time_s: Vec<f64>,
    /// Filtered position as the regulator uses it and as the lab logged it, degrees.
    pub position_deg: Vec<f64>,
    /// Metrics that the control core computed.
    pub metrics: StepReport,
}

/// Target of all steps of the report, degrees.
pub const TARGET_DEG: f64 = 10.0;

impl Apparatus {
    /// The closed loop, with the paddle at the start angle of the step.
    pub fn setup(&self, step: &Step) -> LoopSetup {
        let [kp_nm_per_deg, ki_nm_per_deg_s, kd_nm_s_per_deg] = step.gains;
        let mut settings = Settings {
            pid: PidSettings {
                kp_nm_per_deg,
                ki_nm_per_deg_s,
                kd_nm_s_per_deg,
                ..PidSettings::default()
            },
            ..Settings::default()
        };
        settings.estimate.sensor = step.sensor;
        let mut setup = presets::lab(settings);
        for effect in &self.with {
            effect.install(&mut setup.paddle.device);
        }
        let reading_rad = step.start_deg.to_radians();
        setup.paddle.start_rad = match step.sensor {
            Sensor::Encoder => reading_rad,
            Sensor::Hall => setup.paddle.hall.sensing.inverse(reading_rad),
        };
        setup
    }

    /// Simulates the step.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses, which can happen with added effects.
    pub fn step(&self, step: &Step) -> Result<Response, Failure> {
        let setup = self.setup(step);
        let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position)?;
        let to_target = Experiment {
            reference: Some(0.0),
            ..Experiment::position(
                Excitation::step(TARGET_DEG.to_radians() as f32),
                step.seconds,
            )
        };
        let trace = to_target.run(&mut closed_loop)?;
        if let Some((time_s, fault)) = trace.fault {
            return Err(Failure::Stopped { time_s, fault });
        }
        // A step without metrics never began.
        let metrics = closed_loop.controller().metrics();
        let metrics = metrics.ok_or(ExperimentError::Excitation(ExcitationError::Disarmed))?;
        Ok(Response {
            position_deg: trace.regulated_rad.iter().map(|x| x.to_degrees()).collect(),
            time_s: trace.time_s,
            metrics,
        })
    }
}

impl Response {
    /// Time in ms and position in degrees over the first `seconds`.
    pub fn points(&self, seconds: f64) -> Vec<(f64, f64)> {
        let samples = self.time_s.iter().zip(&self.position_deg);
        samples
            .take_while(|(time_s, _)| **time_s <= seconds)
            .map(|(time_s, position_deg)| (1e3 * time_s, *position_deg))
            .collect()
    }
}
