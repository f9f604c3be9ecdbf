//! What lies between the position and its reading.

use super::Evidence;
use super::start::{count, geometric, linear, log, term, terms};
use super::{actuation, jumps, overspeed, ripple};
use crate::fit::hypothesis::{Coordinate, Term};
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::plant::Mechanics;

/// How wide a play of the reading may be: down to so many noises, or where there is next to none to a share of the widest,
/// and up to a share of the span; and the ratio of those that are tried.
const LEAST_PLAY: f64 = 3.0;
const LEAST_PLAY_SHARE: f64 = 1e-4;
const WIDEST_PLAY: f64 = 0.2;
const PLAY_RATIO: f64 = 2.0;
/// Way after a turn, over that width, within which a reading softly comes to stay behind: at first it moves by a third.
const SOFT_REACH: f64 = 1.5;
/// How far from the middle of the motion a gain may well read right, over its span.
const RIGHT: f64 = 0.2;
/// Square and cube by which a sensor's curve departs at the ends of the motion, over half of its span.
const BENDS: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [0.2, 0.0],
    [-0.2, 0.0],
    [0.0, 0.3],
    [0.0, -0.15],
];
/// Which of a curve's numbers are its cube and the place around which it is bent.
const CUBIC: usize = 1;
const MIDDLE: usize = 6;
/// Which of a lag's numbers says that there are two of it.
const TWICE: usize = 1;
/// Periods of a ripple over the span of the motion.
const RIPPLES: [f64; 3] = [0.5, 1.0, 2.0];

pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    match kind.name {
        "sensor_gain" => {
            let about_zero = vec![log(0, 1.0)];
            let elsewhere = vec![log(0, 1.0), linear(1, s.middle(), RIGHT * s.span())];
            let elsewhere = knows_where(&e.device.mechanics).then_some(elsewhere);
            terms(kind, elsewhere, [about_zero])
        }
        "sensor_nonlinearity" => curves(kind, e),
        "sensor_hysteresis" => {
            let widest = WIDEST_PLAY * s.span();
            let least = LEAST_PLAY * s.noise;
            let sizes = [least.clamp(LEAST_PLAY_SHARE * widest, 0.5 * widest), widest];
            let widths = geometric(sizes, count(sizes, PLAY_RATIO));
            let play = widths.clone().map(|width| vec![log(0, width)]);
            let soft = widths.map(|width| vec![log(0, width), log(1, SOFT_REACH * width)]);
            [terms(kind, None, play), terms(kind, None, soft)].concat()
        }
        "sensor_lag" => {
            let once = actuation::late(kind, e);
            let twice = actuation::twice(&once, TWICE);
            [once, twice].concat()
        }
        "lost_counts" => [jumps::starts(kind, e), overspeed::starts(kind, e)].concat(),
        _ => Vec::new(),
    }
}

/// True if the device goes otherwise where it stands elsewhere.
fn knows_where(mechanics: &Mechanics) -> bool {
    let meets = mechanics.barriers.iter().any(Option::is_some);
    mechanics.is_pulled() || mechanics.cogging.is_some() || meets
}

/// A curve that is bent around another place, where that was given.
pub(super) fn shape(given: &Term, half_span: f64) -> Option<Vec<Coordinate>> {
    let is_bent = given.kind.name == "sensor_nonlinearity" && given.is_free(CUBIC);
    let middle = || linear(MIDDLE, given.values[MIDDLE], 0.2 * half_span);
    (is_bent && !given.is_free(MIDDLE)).then(|| vec![middle()])
}

/// Curves that bend, and an eccentric disk or poles, which show as a ripple of which one period or a few are passed.
fn curves(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let reach = s.position[0].abs().max(s.position[1].abs());
    let middle = s.middle();
    // A curve that is right at zero, or in the middle of what is passed.
    let bent = |middle: f64, reach: f64, [square, cube]: [f64; 2]| {
        let free = vec![
            linear(0, square / reach, 0.2 / reach),
            linear(1, cube / (reach * reach), 0.2 / (reach * reach)),
        ];
        term(kind, free, &[(MIDDLE, middle)])
    };
    let rippled = |turns: f64| {
        let wave_number = turns * TAU / s.span();
        let amplitude = 0.1 / wave_number;
        let waves = linear(4, wave_number, 0.2 * wave_number);
        ripple::start(kind, e, [0.0, amplitude], amplitude, waves)
    };
    let mut all = vec![bent(0.0, reach, [0.0, 0.0])];
    all.extend(BENDS.map(|bend| bent(middle, 0.5 * s.span(), bend)));
    all.extend(RIPPLES.map(rippled));
    all.extend(ripple::starts(kind, e));
    all
}
