//! A counter that cannot follow fast motion.

use super::Evidence;
use super::start::log;
use crate::hypothesis::Term;
use crate::motion::quantile;
use host_sim::effects::Kind;

/// Shares of the windows that begin no faster than what is counted in full.
const SLOWER: [f64; 3] = [0.4, 0.7, 0.9];
/// Lost beyond.
const LOST: f64 = 0.1;
/// Places of the share that is lost and of the speed.
const PLACES: [usize; 2] = [2, 3];

/// Speeds from which on it may lose counts; none where nothing moves.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let windows = e.series.iter().flat_map(|series| &series.windows);
    let speeds: Vec<f64> = windows.map(|window| window.restart.slope.abs()).collect();
    let speeds = SLOWER.map(|share| quantile(&speeds, share)).into_iter();
    let starts = speeds.filter(|speed| *speed > 0.0).map(|speed| {
        let start = [LOST, speed];
        let mut values = kind.events(&[]);
        values.fill(0.0);
        for (place, value) in PLACES.into_iter().zip(start) {
            values[place] = value;
        }
        Term {
            kind,
            values,
            free: PLACES
                .into_iter()
                .zip(start)
                .map(|(place, value)| log(place, value))
                .collect(),
            sensor_on_load: false,
        }
    });
    starts.collect()
}
