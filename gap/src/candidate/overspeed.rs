//! A counter that cannot follow fast motion.

use super::Evidence;
use super::start::{log, term};
use crate::fit::hypothesis::Term;
use crate::windows::motion::{quantile, rms};
use crate::windows::series::Series;
use host_sim::effects::Kind;

/// Shares of the windows that begin no faster than what is counted in full.
const SLOWER: [f64; 3] = [0.4, 0.7, 0.9];
/// Lost beyond.
const LOST: f64 = 0.1;
/// Places of the share that is lost, and of the speed beyond which it is.
const SHARE_LOST: usize = 2;
const FROM_SPEED: usize = 3;
/// A jump that is none: its instant and its height, among the numbers.
const NO_JUMP: [(usize, f64); 2] = [(0, 0.0), (1, 0.0)];

/// Share of its root mean square speed below which no motion is to be seen.
const STANDSTILL: f64 = 0.05;

/// True if counts are lost of any motion at these speeds: what loses all along is a scale.
pub(crate) fn loses_all_along(lost: &Term, speeds: &[f64]) -> bool {
    let [share, from] = [SHARE_LOST, FROM_SPEED].map(|place| lost.values[place]);
    share > 0.0 && from < STANDSTILL * rms(speeds)
}

/// Speeds from which on it may lose counts; none where nothing moves.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let speeds = e.series.iter().flat_map(Series::restart_speeds);
    let speeds: Vec<f64> = speeds.collect();
    let speeds = SLOWER.map(|share| quantile(&speeds, share)).into_iter();
    let moving = speeds.filter(|speed| *speed > 0.0);
    moving
        .map(|speed| {
            term(
                kind,
                vec![log(SHARE_LOST, LOST), log(FROM_SPEED, speed)],
                &NO_JUMP,
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::effects;

    #[test]
    fn what_is_lost_of_any_motion_is_a_scale() {
        let kind = effects::kind("lost_counts").unwrap();
        let speeds = [0.0, 1.0, 2.0, 3.0];
        let lost = |share, from| {
            let numbers = [(SHARE_LOST, share), (FROM_SPEED, from)];
            loses_all_along(&term(kind, Vec::new(), &numbers), &speeds)
        };
        assert!(lost(0.1, 0.02) && !lost(0.1, 0.5));
        // Of jumps there is neither.
        assert!(!lost(0.0, 0.0));
    }
}
