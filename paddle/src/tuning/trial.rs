//! Simulates a step of one loop with one set of gains.

use super::gains::Gains;
use crate::failure::Failure;
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::metrics::StepReport;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::experiment::{Experiment, ExperimentError, Trace};
use host_sim::paddle::Actuator;

/// Result of a step.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Log of the step.
    pub trace: Trace,
    /// Metrics that the control core computed.
    pub metrics: StepReport,
}

/// Simulates a step of `amplitude_deg` with `gains` on `setup`, for `seconds`.
///
/// # Errors
/// Returns a [`Failure`] for gains outside the limits of the console, and if the controller refuses. A controller that stops
/// during the step is not a failure.
pub fn step(
    setup: &LoopSetup,
    gains: &Gains,
    amplitude_deg: f64,
    seconds: f64,
) -> Result<Trial, Failure> {
    let mut setup = setup.clone();
    gains
        .put(&mut setup.settings)
        .map_err(|error| Failure::setting("pid", error))?;
    // The stall monitor is off, because the caller judges a paddle that does not move.
    setup.settings.limit.stall_s = 0.0;
    if setup.paddle.actuator == Actuator::Ideal {
        // An ideal torque actuator has no voltage, so the mismatch limit is disabled.
        setup.settings.limit.mismatch_v = f32::INFINITY;
    }
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position)?;
    let step = Excitation::step(amplitude_deg.to_radians() as f32);
    let trace = Experiment::position(step, seconds).run(&mut closed_loop)?;
    // A step without metrics never began.
    let metrics = closed_loop.controller().metrics();
    let metrics = metrics.ok_or(ExperimentError::Excitation(ExcitationError::Disarmed))?;
    Ok(Trial { trace, metrics })
}

impl Trial {
    /// Time in ms and filtered position in degrees.
    pub fn points(&self) -> Vec<(f64, f64)> {
        let samples = self.trace.time_s.iter().zip(&self.trace.regulated_rad);
        samples.map(|(t, x)| (1e3 * t, x.to_degrees())).collect()
    }
}
