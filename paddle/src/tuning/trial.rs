//! A step of one loop with one set of gains.

use super::gains::Gains;
use crate::failure::Failure;
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::metrics::StepReport;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::experiment::{Experiment, ExperimentError, Trace};
use host_sim::paddle::Actuator;

/// What came of it.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The log.
    pub trace: Trace,
    /// By the control core.
    pub metrics: StepReport,
}

/// Makes a step of `amplitude_deg` with `gains` on `setup` and watches it for `seconds`.
///
/// # Errors
/// [`Failure`] for gains beyond the console's bounds, or if the controller refuses; not if it stops.
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
    // What a paddle that sticks means is for the caller to say.
    setup.settings.limit.stall_s = 0.0;
    if setup.paddle.actuator == Actuator::Ideal {
        // A torque that is there at once has no voltage.
        setup.settings.limit.mismatch_v = f32::INFINITY;
    }
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position)?;
    let step = Excitation::step(amplitude_deg.to_radians() as f32);
    let trace = Experiment::position(step, seconds).run(&mut closed_loop)?;
    // A step without metrics is one that never began.
    let metrics = closed_loop.controller().metrics();
    let metrics = metrics.ok_or(ExperimentError::Excitation(ExcitationError::Disarmed))?;
    Ok(Trial { trace, metrics })
}

impl Trial {
    /// Time and filtered position, ms and degrees.
    pub fn points(&self) -> Vec<(f64, f64)> {
        let samples = self.trace.time_s.iter().zip(&self.trace.regulated_rad);
        samples.map(|(t, x)| (1e3 * t, x.to_degrees())).collect()
    }
}
