//! What a step response must be.

use super::gains::Gains;
use super::margins::Margins;
use haptic_paddle::metrics::StepReport;

/// Upper bounds on a step, lower bounds on margins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specification {
    /// Share of the height of the step.
    pub overshoot_share: f64,
    /// s.
    pub rise_s: f64,
    /// s.
    pub settling_s: f64,
    /// Within which it must stay to be settled, degrees.
    pub band_deg: f64,
    /// dB.
    pub gain_margin_db: f64,
    /// Degrees.
    pub phase_margin_deg: f64,
}

/// Load of a bound that is missed beyond measure; what is asked and what is had then tell how far.
const BEYOND: f64 = 10.0;

impl Specification {
    /// How much of the tightest bound a step of `height_rad` takes, 1 = all of it. A time that is never reached counts
    /// more than any that is.
    pub fn load_of_step(&self, metrics: &StepReport, height_rad: f64) -> f64 {
        let off = (f64::from(metrics.steady_state_error_rad) / height_rad).abs();
        let share = |time_s: Option<f32>, bound_s: f64| match time_s {
            Some(time_s) => f64::from(time_s) / bound_s,
            None => BEYOND + off,
        };
        let overshoot = f64::from(metrics.overshoot_rad) / height_rad.abs();
        [
            overshoot / self.overshoot_share,
            share(metrics.rise_s, self.rise_s),
            share(metrics.settling_s, self.settling_s),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }

    /// The same of where the paddle may be held; see [`rest_error_deg`].
    pub fn load_of_rest(&self, held_nm: f64, gains: &Gains) -> f64 {
        rest_error_deg(held_nm, gains, self.settling_s) / self.band_deg
    }

    /// The same of margins; a loop whose gain is never 1 has all the margin there is.
    pub fn load_of_margins(&self, margins: Option<&Margins>) -> f64 {
        let Some(margins) = margins else {
            return 0.0;
        };
        let share = |asked: f64, had: f64| match had > 0.0 {
            true => asked / had,
            false => BEYOND - had,
        };
        share(self.gain_margin_db, margins.gain_db)
            .max(share(self.phase_margin_deg, margins.phase_deg))
    }
}

/// How far from the target a torque `held_nm` at the paddle can hold it against proportional and integral action after
/// `seconds` there, degrees.
pub fn rest_error_deg(held_nm: f64, gains: &Gains, seconds: f64) -> f64 {
    held_nm / (gains.kp + gains.ki * seconds)
}
