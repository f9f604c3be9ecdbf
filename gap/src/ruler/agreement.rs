//! Estimates how certain the name of an effect is: how often it is chosen when the windows are resampled.

use super::scored::{Scored, simplest_on};
use crate::shrink::Picks;

/// Number of resamplings of the windows.
const RESAMPLINGS: usize = 200;
/// Number of windows in a block that is drawn as a whole. Adjacent windows have correlated model errors.
const BLOCK: usize = 3;

/// Returns the share of resamplings in which the set of [`simplest_on`] contains the name. Windows are resampled in blocks.
pub(super) fn share(sets: &[Scored], name: &str) -> f64 {
    let windows = sets.first().map_or(0, |set| set.unseen.len());
    let blocks = windows.div_ceil(BLOCK);
    if blocks == 0 {
        return 0.0;
    }
    let mut random = Picks::new();
    let mut drawn = Vec::with_capacity(windows);
    let mut hits = 0;
    for _ in 0..RESAMPLINGS {
        drawn.clear();
        for _ in 0..blocks {
            let first = random.below(blocks) * BLOCK;
            drawn.extend(first..(first + BLOCK).min(windows));
        }
        let chosen = simplest_on(sets, &drawn);
        hits += usize::from(chosen.is_some_and(|set| set.names().contains(&name)));
    }
    hits as f64 / RESAMPLINGS as f64
}
