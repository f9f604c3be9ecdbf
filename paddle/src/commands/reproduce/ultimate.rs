//! The ultimate gain and period of Ziegler and Nichols.

use super::apparatus::{Apparatus, Step, TARGET_DEG};
use super::row::Row;
use crate::failure::Failure;
use crate::tuning::oscillation::{Oscillation, SUSTAINED};
use crate::tuning::ziegler_nichols::Ultimate;
use haptic_paddle::settings::Sensor;

/// A step at the lab's ultimate gain, without integral and derivative action, from the angle at which its log starts.
const STEP: Step = Step {
    sensor: Sensor::Hall,
    gains: [0.05, 0.0, 0.0],
    start_deg: 0.645,
    seconds: 2.0,
};
const KU: f64 = 0.05;
const TU_MS: f64 = 86.7;
const TU_BAR_SHARE: f64 = 0.05;
/// Number of cycles over which the lab averaged the period.
const CYCLES: usize = 20;

const BY_HAND: &str =
    "raised by 5 % until 20 swings do not die down; the lab raised it by hand until it saw swings";

/// Rows of the oscillation at the lab's ultimate gain, and of the gain that `paddle sim zn` finds.
///
/// # Errors
/// Returns a [`Failure`] if the controller refuses or stops.
pub fn rows(apparatus: &Apparatus) -> Result<[Row; 3], Failure> {
    let response = apparatus.step(&STEP)?;
    let all = Oscillation::about(TARGET_DEG, &response.time_s, &response.position_deg);
    let kept = match all.swings.len() >= CYCLES {
        true => all.first(CYCLES).kept(),
        false => 0.0,
    };
    let period_s = all.first(CYCLES).period_s().unwrap_or(f64::INFINITY);
    let found = Ultimate::find(&apparatus.setup(&STEP), TARGET_DEG)?;
    Ok([
        Row::new(
            "Kp 0.05 alone, 20th swing over the first",
            Some(1.0),
            kept,
            "1",
        )
        .between([SUSTAINED, f64::INFINITY])
        .remarked("sustained: it grows until the torque limit holds it"),
        Row::new(
            "Kp 0.05 alone, period Tu",
            Some(TU_MS),
            1e3 * period_s,
            "ms",
        )
        .within_share(TU_BAR_SHARE, TU_MS),
        Row::new("ultimate gain Ku, found", Some(KU), found.gain, "N m/°").remarked(BY_HAND),
    ])
}
