//! A reading that stays behind after a turn.

use super::identification::Identification;
use super::phrase::Found;
use crate::columns::{Disagreement, lowest};
use crate::guess::Evidence;
use crate::guess::start::{count, geometric, log, terms};
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::sensor_hysteresis::KIND;

/// How wide it may be: down to so many noises, or where there is next to none to a share of the widest, and up to a share of
/// the span; and the ratio of the widths that are tried.
const LEAST_PLAY: f64 = 3.0;
const LEAST_PLAY_SHARE: f64 = 1e-4;
const WIDEST_PLAY: f64 = 0.2;
const PLAY_RATIO: f64 = 2.0;
/// Way after a turn, over that width, within which a reading softly comes to stay behind: at first it moves by a third.
const SOFT_REACH: f64 = 1.5;
/// Widths between two columns, over the span of the motion.
const WIDTHS: [f64; 2] = [1e-4, 0.5];
/// Ways after a turn within which a column comes to stay behind, over that width; none for play.
const REACHES: [f64; 3] = [0.0, 1.5, 3.0];

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
        let soft = widths.map(|width| vec![log(0, width), log(1, SOFT_REACH * width)]);
        [terms(&KIND, None, play), terms(&KIND, None, soft)].concat()
    }

    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let of_reach = |reach: f64| {
            let range = WIDTHS.map(|f| f * columns.span);
            let values = |width: f64| vec![width, reach * width];
            values(lowest(range, |width| columns.left(&KIND, &values(width))))
        };
        REACHES.map(of_reach).to_vec()
    }

    fn noun(&self) -> &'static str {
        "hysteresis of the sensor"
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a sensor with {width} of hysteresis"
    }
}
