//! A counter that cannot follow fast motion.

use super::Evidence;
use super::start::{log, term};
use crate::fit::hypothesis::Term;
use crate::windows::motion::quantile;
use host_sim::effects::Kind;

/// Shares of the windows that begin no faster than what is counted in full.
const SLOWER: [f64; 3] = [0.4, 0.7, 0.9];
/// Lost beyond.
const LOST: f64 = 0.1;
/// A jump that is none: its instant and its height, among the numbers.
const NO_JUMP: [(usize, f64); 2] = [(0, 0.0), (1, 0.0)];

/// Speeds from which on it may lose counts; none where nothing moves.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let windows = e.series.iter().flat_map(|series| &series.windows);
    let speeds: Vec<f64> = windows.map(|window| window.restart.slope.abs()).collect();
    let speeds = SLOWER.map(|share| quantile(&speeds, share)).into_iter();
    let moving = speeds.filter(|speed| *speed > 0.0);
    moving
        .map(|speed| term(kind, vec![log(2, LOST), log(3, speed)], &NO_JUMP))
        .collect()
}
