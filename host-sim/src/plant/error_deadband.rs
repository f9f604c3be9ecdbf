//! The dead band of a position servo.

use super::{Law, Moment, TorqueLaw};
use recording::Model;
use std::sync::Arc;

/// The difference, N m, that a dead band makes to a servo with the torque `ratio · (input − position)`. Within the dead band
/// it cancels this torque. Beyond, it reduces the magnitude by `ratio` times the half width.
///
/// The parameters are the half width in position units, the ratio in N m per unit of input, and the position at which the
/// servo rests with zero input.
#[derive(Debug)]
struct ErrorDeadband;

impl TorqueLaw for ErrorDeadband {
    fn torque_nm(&self, at: &Moment, parameters: &[f64]) -> f64 {
        let &[half_width, ratio, zero] = parameters else {
            return 0.0;
        };
        let error = at.input - (at.position - zero);
        -ratio * error.max(-half_width).min(half_width)
    }

    fn text(&self) -> String {
        "-ratio * clamp(input - (position - zero), -half_width, half_width)".into()
    }
}

/// The law of a model's dead band of the position error. `None` if it has no dead band.
pub(crate) fn error_deadband(model: &Model) -> Option<Law> {
    let half_width = model
        .error_deadband
        .filter(|&half_width| half_width > 0.0)?;
    let parameters = vec![half_width, model.ratio, model.stiffness_zero];
    Some(Law::new(Arc::new(ErrorDeadband), parameters, model.ratio))
}
