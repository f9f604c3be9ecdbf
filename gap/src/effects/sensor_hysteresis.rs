//! Hysteresis of the sensor: the reading lags by a fixed distance after a reversal.

use super::identification::Identification;
use super::phrase::Found;
use crate::columns::{Disagreement, lowest};
use crate::guess::Evidence;
use crate::guess::start::{count, geometric, log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::{Moment, Path, sign, torque};
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::sensor_hysteresis::KIND;

/// Limits of the widths that are tried, and the ratio between neighbours. The narrowest is a multiple of the noise, or a share of the
/// widest if there is almost no noise. The widest is a share of the range of the motion.
const LEAST_PLAY: f64 = 3.0;
const LEAST_PLAY_SHARE: f64 = 1e-4;
const WIDEST_PLAY: f64 = 0.2;
const PLAY_RATIO: f64 = 2.0;
/// Distance after a reversal over which a gradual hysteresis builds up, over its width.
const BUILD_UP_DISTANCE: f64 = 1.5;
/// Range of the widths between two columns, over the range of the motion.
const WIDTHS: [f64; 2] = [1e-4, 0.5];
/// Distances after a reversal over which the hysteresis between two columns builds up, over its width; 0 for play.
const BUILD_UP_DISTANCES: [f64; 3] = [0.0, 1.5, 3.0];
/// Halves of the play that are screened for the missing torque, over half of the range of the motion.
const HALF_PLAYS_SCREENED: [f64; 7] = [0.005, 0.01, 0.02, 0.035, 0.06, 0.1, 0.16];

#[derive(Debug)]
pub(super) struct SensorHysteresis;

impl Identification for SensorHysteresis {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let widest = WIDEST_PLAY * s.span();
        let least = LEAST_PLAY * s.noise;
        let sizes = [least.clamp(LEAST_PLAY_SHARE * widest, 0.5 * widest), widest];
        let widths = geometric(sizes, count(sizes, PLAY_RATIO));
        let play = widths.clone().map(|width| vec![log(0, width)]);
        let gradual = widths.map(|width| vec![log(0, width), log(1, BUILD_UP_DISTANCE * width)]);
        [terms(&KIND, None, play), terms(&KIND, None, gradual)].concat()
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let with_build_up = |reach: f64| {
            let range = WIDTHS.map(|f| f * columns.span);
            let values = |width: f64| vec![width, reach * width];
            values(lowest(range, |width| columns.left(&KIND, &values(width))))
        };
        BUILD_UP_DISTANCES.map(with_build_up).to_vec()
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let half_plays = HALF_PLAYS_SCREENED.map(|part| part * path.scale.half_span());
        half_plays
            .map(|half_play| play_form(path, half_play))
            .into()
    }

    fn noun(&self) -> &'static str {
        "hysteresis of the sensor"
    }

    fn tell_apart(&self) -> &'static str {
        "The reading stays behind by the same distance after each reversal, at any speed. A lag of the sensor stays behind in proportion to the speed. Presliding has such a loop in the torque. A second sensor of the same position decides."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a sensor with {width} of hysteresis"
    }
}

/// The form of a reading that lags by half of the play. After a reversal the reading is constant until the position has crossed the play.
/// Then it suddenly follows the position.
fn play_form(path: &Path<'_>, half_play: f64) -> Form {
    let m = &path.device.mechanics;
    let n = path.position.len();
    let mut reading = vec![0.0; n];
    let mut torques = vec![0.0; n];
    // Sign of the error of the reading, and distance and velocity of the position since the reading became constant.
    let (mut side, mut distance, mut speed) = (0.0, 0.0, 0.0);
    for i in 0..n {
        let reading_state = path.at(i);
        let step_s = path.samples.step_s[i];
        if reading_state.is_sliding && reading_state.direction.abs() == 1.0 {
            side = -reading_state.direction;
            (distance, speed) = (0.0, reading_state.velocity);
            reading[i] = half_play * side;
        } else {
            let real = Moment {
                velocity: speed,
                direction: sign(speed),
                is_sliding: speed != 0.0,
                ..reading_state
            };
            let acceleration = torque(m, path.drive[i], &real) / m.inertia;
            speed += acceleration * step_s;
            distance = (distance + speed * side * step_s).clamp(0.0, 2.0 * half_play);
            // The position moves on, then reverses and comes back through the play.
            reading[i] = side * (half_play - distance);
        }
        let real = Moment {
            position: reading_state.position - reading[i],
            ..reading_state
        };
        let real = if reading_state.is_sliding {
            real
        } else {
            Moment {
                velocity: speed,
                direction: sign(speed),
                is_sliding: speed != 0.0,
                ..real
            }
        };
        torques[i] = torque(m, path.drive[i], &real) - torque(m, path.drive[i], &reading_state);
        if step_s == 0.0 {
            (side, distance, speed) = (0.0, 0.0, 0.0);
        }
    }
    let form = Form::new(vec![torques], move |c| {
        with_defaults(&KIND, &[(0, 2.0 * half_play * c[0].max(0.1))])
    });
    Form {
        reading: vec![reading],
        ..form.searched(1).positive()
    }
}
