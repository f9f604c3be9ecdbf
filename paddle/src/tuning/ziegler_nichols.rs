//! The ultimate-cycle method of J. G. Ziegler and N. B. Nichols (Transactions of the ASME 64, 1942), as in the report. The
//! proportional gain is raised until the loop sustains an oscillation, and the gains follow from that oscillation.

use super::gains::Gains;
use super::oscillation::Oscillation;
use super::trial::{self, Trial};
use crate::failure::Failure;
use host_sim::closed_loop::LoopSetup;

/// The loop at its stability limit.
#[derive(Clone, Debug)]
pub struct Ultimate {
    /// Ultimate gain Ku, N m per degree at the paddle.
    pub gain: f64,
    /// Ultimate period Tu, s.
    pub period_s: f64,
    /// The step that showed the oscillation.
    pub trial: Trial,
    /// Number of gains that were tried; the last one is Ku.
    pub tried: usize,
}

/// Smallest gain that is tried, N m per degree at the paddle.
const FROM: f64 = 0.002;
/// Largest gain that is tried; it is the limit of the console, N m per degree at the paddle.
const TO: f64 = 2.0;
/// Ratio of consecutive gains.
const RAISE: f64 = 1.05;
/// Number of cycles that must not decay.
const CYCLES: usize = 20;
/// Number of such cycles if the oscillation grows until the controller stops it.
const CYCLES_TO_THE_STOP: usize = 5;
/// Duration of a step, s. It is long enough for these cycles at the smallest gain.
const WATCHED_S: f64 = 6.0;

impl Ultimate {
    /// Raises the gain on `setup` until a step of `amplitude_deg` sustains an oscillation.
    ///
    /// # Errors
    /// Returns a [`Failure`] if no gain sustains an oscillation, or if the paddle exceeds its travel first.
    pub fn find(setup: &LoopSetup, amplitude_deg: f64) -> Result<Self, Failure> {
        let mut gain = FROM;
        for tried in 1.. {
            if gain > TO {
                break;
            }
            let gains = Gains::proportional(gain).rounded();
            let trial = trial::step(setup, &gains, amplitude_deg, WATCHED_S)?;
            let swinging = swings(&trial, amplitude_deg.to_radians());
            let cycles = match trial.trace.fault {
                Some(_) => CYCLES_TO_THE_STOP,
                None => CYCLES,
            };
            if let (true, Some(period_s)) = (
                swinging.is_sustained(cycles),
                swinging.first(CYCLES).period_s(),
            ) {
                return Ok(Self {
                    gain: gains.kp,
                    period_s,
                    trial,
                    tried,
                });
            }
            if let Some((time_s, fault)) = trial.trace.fault {
                return Err(Failure::Stopped { time_s, fault });
            }
            gain *= RAISE;
        }
        Err(Failure::NeverSwings(TO))
    }

    /// PID gains: Kp = 0.6 Ku, Ki = Kp / (Tu / 2), Kd = Kp Tu / 8.
    pub fn pid(&self) -> Gains {
        let kp = 0.6 * self.gain;
        Gains {
            kp,
            ki: kp / (self.period_s / 2.0),
            kd: kp * self.period_s / 8.0,
        }
        .rounded()
    }
}

/// The oscillation about the setpoint up to the end, or up to the time at which the controller stopped.
fn swings(trial: &Trial, level_rad: f64) -> Oscillation {
    let trace = &trial.trace;
    let end_s = trace.fault.map_or(f64::INFINITY, |(time_s, _)| time_s);
    let driven = trace.time_s.partition_point(|time_s| *time_s < end_s);
    Oscillation::about(
        level_rad,
        &trace.time_s[..driven],
        &trace.regulated_rad[..driven],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_paddle::settings::Settings;
    use host_sim::presets;

    #[test]
    fn the_gains_follow_from_the_reports_ultimate_cycle() {
        let setup = presets::lab(Settings::default());
        let found = Ultimate {
            gain: 0.05,
            period_s: 86.7e-3,
            trial: trial::step(&setup, &Gains::proportional(0.05), 10.0, 0.1).unwrap(),
            tried: 1,
        };
        let gains = found.pid();
        assert_eq!((gains.kp, gains.ki, gains.kd), (0.03, 0.692, 0.000325));
    }

    #[test]
    fn a_gain_below_the_ultimate_gain_gives_a_decaying_oscillation() {
        let setup = presets::lab(Settings::default());
        let ultimate = Ultimate::find(&setup, 10.0).unwrap();
        let below = Gains::proportional(0.8 * ultimate.gain);
        let trial = trial::step(&setup, &below, 10.0, WATCHED_S).unwrap();
        assert!(!swings(&trial, 10f64.to_radians()).is_sustained(CYCLES));
        assert!(ultimate.tried > 1 && (0.04..0.08).contains(&ultimate.gain));
    }
}
