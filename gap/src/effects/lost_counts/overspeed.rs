//! An encoder that loses counts during fast motion.

use crate::columns::{Disagreement, Track, less_mean, lowest, mean_square, residuals};
use crate::fit::whitening::dot;
use crate::guess::Evidence;
use crate::guess::start::{log, term};
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::term::Term;
use crate::windows::series::Series;
use crate::windows::statistics::{quantile, rms};
use host_sim::effects::lost_counts::KIND;

/// Starts of the speed beyond which counts are lost, as quantiles of the speeds at the begin of the windows.
const SPEED_QUANTILES: [f64; 3] = [0.4, 0.7, 0.9];
/// Start of the share of the speed that is lost.
const LOST: f64 = 0.1;
/// Indices of the parameters `share` and `speed`.
const SHARE_LOST: usize = 2;
const FROM_SPEED: usize = 3;
/// The parameters of a jump of height 0.
const NO_JUMP: [(usize, f64); 2] = [(0, 0.0), (1, 0.0)];
/// Range of the speeds that are tried between two columns, over the highest speed.
const SPEEDS: [f64; 2] = [0.02, 0.98];

/// Speeds that are screened for the missing torque, over the rms speed, and the lost share per unit of the coefficient.
const SPEEDS_SCREENED: [f64; 6] = [0.3, 0.5, 0.7, 0.9, 1.15, 1.45];
const SHARE_STEP: f64 = 0.1;
/// Share of the rms speed below which the sensor counts as at standstill.
const STANDSTILL: f64 = 0.05;

/// True if counts are lost at every speed. A sensor that always loses the same share has a different gain.
pub(super) fn loses_at_every_speed(lost: &Term, speeds: &[f64]) -> bool {
    let [share, from] = [SHARE_LOST, FROM_SPEED].map(|place| lost.values[place]);
    share > 0.0 && from < STANDSTILL * rms(speeds)
}

/// Starts of the speed beyond which counts are lost. Returns none without motion.
pub(super) fn starts(e: &Evidence<'_>) -> Vec<Term> {
    let speeds = e.series.iter().flat_map(Series::restart_speeds);
    let speeds: Vec<f64> = speeds.collect();
    let speeds = SPEED_QUANTILES
        .map(|share| quantile(&speeds, share))
        .into_iter();
    let moving = speeds.filter(|speed| *speed > 0.0);
    moving
        .map(|speed| {
            term(
                &KIND,
                vec![log(SHARE_LOST, LOST), log(FROM_SPEED, speed)],
                &NO_JUMP,
            )
        })
        .collect()
}

/// The parameters with which the loss of counts explains the difference between two columns best.
pub(super) fn between_columns(columns: &Disagreement<'_>) -> Option<Vec<f64>> {
    let fastest = columns.columns.tracks.iter().flat_map(Track::rates);
    let fastest = fastest.fold(0.0f64, |fastest, rate| fastest.max(rate.abs()));
    let values = |speed: f64, share: f64| {
        let mut values = KIND.events(&[[0.0; 2]]);
        values[2..].copy_from_slice(&[share, speed]);
        values
    };
    let difference = less_mean(columns.difference.clone());
    // The best share by least squares, since the loss is proportional to it, and the mean squared residual.
    let fitted = |speed: f64| {
        let all = residuals(&columns.columns.tracks, &KIND, &values(speed, 1.0));
        let lost: Vec<f64> = all.iter().zip(&difference).map(|(a, d)| a - d).collect();
        let share = -dot(&lost, &difference) / dot(&lost, &lost).max(f64::MIN_POSITIVE);
        let share = share.clamp(0.0, 1.0);
        let left = difference.iter().zip(&lost).map(|(d, l)| d + share * l);
        (share, mean_square(&left.collect::<Vec<_>>()))
    };
    let speed = lowest(SPEEDS.map(|f| f * fastest), |speed| fitted(speed).1);
    let (share, _) = fitted(speed);
    (share > 0.0).then(|| values(speed, share))
}

/// The forms of the apparent missing torque of an encoder that loses counts beyond a speed.
pub(super) fn torque_forms(path: &Path<'_>) -> Vec<Form> {
    let speeds = SPEEDS_SCREENED.map(|part| part * path.scale.velocity);
    speeds.map(|speed| form(path, speed)).into()
}

/// The form of one speed. Beyond it a share of the travel is lost, so that the velocity of the reading jumps there.
fn form(path: &Path<'_>, beyond: f64) -> Form {
    let m = &path.device.mechanics;
    let net = path.torque(path.device);
    let mut before = None;
    let column = (0..net.len()).map(|i| {
        let v = path.velocity[i];
        let loses = f64::from(v.abs() > beyond);
        let step_s = path.samples.step_s[i];
        let change_per_s: f64 = match before {
            Some(before) if step_s > 0.0 => (loses - before) / step_s,
            _ => 0.0,
        };
        before = (step_s > 0.0).then_some(loses);
        -(loses * (net[i] + m.viscous * v) + m.inertia * v * change_per_s) * SHARE_STEP
    });
    let form = Form::new(vec![column.collect()], move |c| {
        let share = (SHARE_STEP * c[0]).clamp(0.0, 1.0);
        with_defaults(
            &KIND,
            &[(1, 0.0), (SHARE_LOST, share), (FROM_SPEED, beyond)],
        )
    });
    form.searched(1).positive()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_at_every_speed_is_recognized_as_a_gain() {
        let speeds = [0.0, 1.0, 2.0, 3.0];
        let lost = |share, from| {
            let numbers = [(SHARE_LOST, share), (FROM_SPEED, from)];
            loses_at_every_speed(&term(&KIND, Vec::new(), &numbers), &speeds)
        };
        assert!(lost(0.1, 0.02) && !lost(0.1, 0.5));
        // A term with jumps only has neither parameter.
        assert!(!lost(0.0, 0.0));
    }
}
