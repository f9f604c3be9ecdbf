//! Specification of a step response.

use super::gains::Gains;
use super::margins::Margins;
use haptic_paddle::metrics::StepReport;

/// Upper bounds on a step response and lower bounds on margins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specification {
    /// Largest overshoot as a share of the step height.
    pub overshoot_share: f64,
    /// Largest rise time, s.
    pub rise_s: f64,
    /// Largest settling time, s.
    pub settling_s: f64,
    /// Half width of the settling band, degrees.
    pub band_deg: f64,
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
}

/// Utilization of a bound without a finite ratio, such as a time that is never reached. A measure of the deviation is added
/// to it.
const BEYOND: f64 = 10.0;

impl Specification {
    /// Utilization of the tightest bound by a step of `height_rad`; 1 means that the bound is just met. A time that is never
    /// reached counts more than any finite time.
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

    /// Utilization of the settling band by the position error at rest; see [`rest_error_deg`].
    pub fn load_of_rest(&self, held_nm: f64, gains: &Gains) -> f64 {
        rest_error_deg(held_nm, gains, self.settling_s) / self.band_deg
    }

    /// Utilization of the margins' bounds. A loop whose gain is never 1 has utilization 0.
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

/// Largest distance from the target, in degrees, at which a torque of `held_nm` at the paddle can hold it after `seconds`,
/// against proportional and integral action.
pub fn rest_error_deg(held_nm: f64, gains: &Gains, seconds: f64) -> f64 {
    held_nm / (gains.kp + gains.ki * seconds)
}
