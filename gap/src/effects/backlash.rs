//! Backlash in the transmission between two masses.

use super::compliance::Compliance;
use super::identification::{Fitted, Identification, Landscape};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{count, linear, log, term};
use crate::guess::two_masses::{HALF, has_friction, is_degenerate_link, two_masses};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::{Path, sign};
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::series::FINE_PERIOD_S;
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::effects::backlash::KIND;

/// Narrowest and widest play that are tried, as shares of the range of the motion, and the ratio between neighbours. If one run moves
/// less than all runs together, narrower plays are tried as well.
const PLAYS: [f64; 2] = [0.0027, 0.15];
const PLAY_RATIO: f64 = 1.78;
/// Natural frequency of the flanks, over the coarse sampling rate. An impact then lasts some samples. Stiffer flanks act nearly equally.
const FLANK_FREQUENCY: f64 = 0.06;
/// Damping ratio of the flanks. A rebound has half of the speed.
const FLANK_DAMPING: f64 = 0.22;
/// Shares of the inertia and of the friction on the load side that are tried with each play. They are observable while one side moves
/// freely.
const FREE_SHARES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const FREE_FRICTIONS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Half of the play, over half of the range of the motion, that are screened for the missing torque.
const HALF_PLAYS_SCREENED: [f64; 5] = [0.006, 0.014, 0.03, 0.06, 0.12];

#[derive(Debug)]
pub(super) struct Backlash;

impl Identification for Backlash {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let inertia = e.device.mechanics.inertia;
        let rate = TAU * FLANK_FREQUENCY / e.scales.period_s.max(FINE_PERIOD_S);
        let has_friction = has_friction(e);
        let frictions = if has_friction {
            &FREE_FRICTIONS[..]
        } else {
            &[HALF]
        };
        let narrower = (e.scales.span() / e.scales.least_span)
            .log(PLAY_RATIO)
            .floor();
        let least = PLAYS[0] * PLAY_RATIO.powf(-narrower);
        let sizes = [least, PLAYS[1]].map(|play| play * e.scales.span());
        two_masses(sizes, count(sizes, PLAY_RATIO), |play| {
            let pairs = FREE_SHARES
                .iter()
                .flat_map(|&share| frictions.iter().map(move |&friction| (share, friction)));
            let start = |(share, friction): (f64, f64)| {
                let reduced = inertia * share * (1.0 - share);
                let mut free = vec![
                    log(0, play),
                    linear(1, share, 0.15),
                    log(2, rate * rate * reduced),
                    log(3, 2.0 * FLANK_DAMPING * rate * reduced),
                ];
                free.extend(has_friction.then(|| linear(4, friction, 0.3)));
                term(&KIND, free, &[])
            };
            pairs.map(start).collect()
        })
    }

    fn landscape(&self) -> Landscape {
        Landscape::Rugged
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&Compliance]
    }

    /// If the damper prevents the spring from relaxing within a prediction, the effect acts like a lag. If one side has no inertia, the
    /// transmission acts like presliding friction. A play narrower than the resolution of the position sensor is not observable.
    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        is_degenerate_link(fit.device, fit.horizon_s) || fit.term.values[0] < fit.resolution
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let carried = path.transmitted_torque();
        let half_plays = HALF_PLAYS_SCREENED.map(|part| part * path.scale.half_span());
        let forms = half_plays.map(|half_play| {
            let columns = free_and_impact_torques(path, &carried, half_play);
            let values = move |c: &[f64]| {
                let share = (0.5 + c[0].abs().min(1.0) * 0.2).clamp(0.1, 0.9);
                with_defaults(&KIND, &[(0, 2.0 * half_play), (1, share)])
            };
            Form::new(columns.into(), values).searched(1)
        });
        forms.into()
    }

    fn noun(&self) -> &'static str {
        "backlash"
    }

    fn tell_apart(&self) -> &'static str {
        "The load flies free for a moment after each reversal of the torque and then hits. A compliant transmission rings at one frequency and has no free way. Record slow reversals under load, with a sensor on either side if there is one."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "backlash of {play}"
    }
}

/// Torque that does not reach the load while the play is crossed, and torque of the impact afterwards, over each step. `carried` is the
/// torque that a transmission without play would transmit.
fn free_and_impact_torques(path: &Path<'_>, carried: &[f64], half_play: f64) -> [Vec<f64>; 2] {
    let inertia = path.device.mechanics.inertia;
    // Side of the contact, distance that the motor moved relative to the load since contact was lost, and velocity of the load at that
    // instant.
    let (mut side, mut relative_travel, mut speed, mut free) = (0.0, 0.0, 0.0, false);
    let n = carried.len();
    let [mut free_torques, mut impacts] = [vec![0.0; n], vec![0.0; n]];
    for i in 0..n {
        let step_s = path.samples.step_s[i];
        if step_s == 0.0 {
            (free, side) = (false, 0.0);
            continue;
        }
        let pushes = sign(carried[i]);
        if !free {
            if side == 0.0 {
                side = pushes;
            }
            if pushes == side || pushes == 0.0 {
                continue;
            }
            (free, relative_travel, speed) = (true, 0.0, path.velocity[i]);
        }
        relative_travel -= side * (path.velocity[i] - speed) * step_s;
        let crossed = relative_travel >= 2.0 * half_play;
        if crossed || relative_travel < -0.5 * half_play {
            impacts[i] = -inertia * (path.velocity[i] - speed) / step_s;
            free = false;
            if crossed {
                side = -side;
            }
        } else {
            free_torques[i] = carried[i];
        }
    }
    [free_torques, impacts]
}
