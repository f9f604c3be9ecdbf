//! A counter that cannot follow fast motion.

use crate::columns::{Disagreement, Track, less_mean, lowest, mean_square, residuals};
use crate::fit::whitening::dot;
use crate::guess::Evidence;
use crate::guess::start::{log, term};
use crate::term::Term;
use crate::windows::series::Series;
use crate::windows::statistics::{quantile, rms};
use host_sim::effects::lost_counts::KIND;

/// Shares of the windows that begin no faster than what is counted in full.
const SLOWER: [f64; 3] = [0.4, 0.7, 0.9];
/// Lost beyond.
const LOST: f64 = 0.1;
/// Places of the share that is lost, and of the speed beyond which it is.
const SHARE_LOST: usize = 2;
const FROM_SPEED: usize = 3;
/// A jump that is none: its instant and its height, among the numbers.
const NO_JUMP: [(usize, f64); 2] = [(0, 0.0), (1, 0.0)];
/// Speeds between two columns, over the fastest motion.
const SPEEDS: [f64; 2] = [0.02, 0.98];

/// Share of its root mean square speed below which no motion is to be seen.
const STANDSTILL: f64 = 0.05;

/// True if counts are lost of any motion at these speeds: what loses all along is a scale.
pub(super) fn loses_all_along(lost: &Term, speeds: &[f64]) -> bool {
    let [share, from] = [SHARE_LOST, FROM_SPEED].map(|place| lost.values[place]);
    share > 0.0 && from < STANDSTILL * rms(speeds)
}

/// Speeds from which on it may lose counts; none where nothing moves.
pub(super) fn starts(e: &Evidence<'_>) -> Vec<Term> {
    let speeds = e.series.iter().flat_map(Series::restart_speeds);
    let speeds: Vec<f64> = speeds.collect();
    let speeds = SLOWER.map(|share| quantile(&speeds, share)).into_iter();
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

/// What a counter loses that cannot follow fast motion.
pub(super) fn between_columns(columns: &Disagreement<'_>) -> Option<Vec<f64>> {
    let fastest = columns.columns.tracks.iter().flat_map(Track::rates);
    let fastest = fastest.fold(0.0f64, |fastest, rate| fastest.max(rate.abs()));
    let values = |speed: f64, share: f64| {
        let mut values = KIND.events(&[[0.0; 2]]);
        values[2..].copy_from_slice(&[share, speed]);
        values
    };
    let difference = less_mean(columns.difference.clone());
    // The share that suits best, as what is lost is in proportion to it, and what it leaves.
    let suited = |speed: f64| {
        let all = residuals(&columns.columns.tracks, &KIND, &values(speed, 1.0));
        let lost: Vec<f64> = all.iter().zip(&difference).map(|(a, d)| a - d).collect();
        let share = -dot(&lost, &difference) / dot(&lost, &lost).max(f64::MIN_POSITIVE);
        let share = share.clamp(0.0, 1.0);
        let left = difference.iter().zip(&lost).map(|(d, l)| d + share * l);
        (share, mean_square(&left.collect::<Vec<_>>()))
    };
    let speed = lowest(SPEEDS.map(|f| f * fastest), |speed| suited(speed).1);
    let (share, _) = suited(speed);
    (share > 0.0).then(|| values(speed, share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_of_any_motion_is_a_scale() {
        let speeds = [0.0, 1.0, 2.0, 3.0];
        let lost = |share, from| {
            let numbers = [(SHARE_LOST, share), (FROM_SPEED, from)];
            loses_all_along(&term(&KIND, Vec::new(), &numbers), &speeds)
        };
        assert!(lost(0.1, 0.02) && !lost(0.1, 0.5));
        // Of jumps there is neither.
        assert!(!lost(0.0, 0.0));
    }
}
