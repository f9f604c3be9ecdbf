//! A lag of the sensor: the reading follows the position with a first-order lag.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use crate::columns::{Disagreement, lowest};
use crate::guess::Evidence;
use crate::guess::delays::{longer_times, two_equal_lags};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::delay_forms::delay_form;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::lag;
use host_sim::effects::sensor_lag::KIND;
use recording::Model;

/// Index of the parameter `twice`.
const TWICE: usize = 1;
/// Range of the lags between two columns, over the duration of a window.
const LAGS: [f64; 2] = [1e-4, 1.0];

#[derive(Debug)]
pub(super) struct SensorLag;

impl Identification for SensorLag {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let once = longer_times(&KIND, e);
        let both = two_equal_lags(&once, TWICE);
        [once, both].concat()
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Lateness)
    }

    fn on_small_motion(&self, fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        let time_s = fitted.values[0];
        Some(SmallMotion::LateReading { time_s })
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let lag = |twice: f64| {
            let range = LAGS.map(|f| f * columns.window_s);
            let time_s = lowest(range, |tau| columns.left(&KIND, &[tau, twice]));
            vec![time_s, twice]
        };
        vec![lag(0.0), lag(1.0)]
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        // A lag of the sensor acts like a delay of the drive and of the friction.
        let delayed = delay_form(path, target, &lag::KIND, 0.0);
        let form = delayed.map(|form| {
            let delay_s = (form.values)(&[1.0])[0];
            let drive = form.torque.into_iter().next().unwrap_or_default();
            let column = with_delayed_friction(path, drive, delay_s);
            let values = move |c: &[f64]| with_defaults(&KIND, &[(0, (delay_s * c[0]).max(0.0))]);
            Form::new(vec![column], values).searched(1).positive()
        });
        form.into_iter().collect()
    }

    fn noun(&self) -> &'static str {
        "lag of the sensor"
    }

    fn tell_apart(&self) -> &'static str {
        "The reading stays behind in proportion to the speed. A lag of the torque delays only what the input causes. In open loop a short lag of either kind is the same. A second sensor of the same position decides."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.value("twice") {
            Some(1.0) => "a sensor that lags by {time}, and by as much again",
            _ => "a sensor that lags by {time}",
        }
    }
}

/// The apparent missing torque of a drive torque and a friction that are delayed by `delay_s`, s. The position is ahead of its reading,
/// and so is its friction.
fn with_delayed_friction(path: &Path<'_>, mut drive: Vec<f64>, delay_s: f64) -> Vec<f64> {
    let friction = &path.device.mechanics.friction;
    let friction_at = |i: usize| friction.level(path.direction[i]) * path.direction[i];
    let last = path.samples.len().saturating_sub(1);
    let rows_ahead = (delay_s / path.samples.period_s) as usize;
    let mut lagging = 0.0;
    for (i, torque) in drive.iter_mut().enumerate() {
        let step_s = path.samples.step_s[i];
        if step_s == 0.0 {
            lagging = friction_at(i);
            continue;
        }
        let passed = 1.0 - (-step_s / delay_s).exp();
        lagging += passed * (friction_at((i + rows_ahead).min(last)) - lagging);
        *torque -= lagging - friction_at(i);
    }
    drive
}
