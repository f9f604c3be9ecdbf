//! Estimates how certain the name of an effect is: how often it is chosen when the windows are resampled.

use super::scored::Scored;
use crate::shrink::Picks;

/// Number of resamplings of the windows.
const RESAMPLINGS: usize = 200;
/// Number of windows in a block that is drawn as a whole. Adjacent windows have correlated model errors.
const BLOCK: usize = 3;

/// Returns the share of resamplings in which the chosen set contains the name. The chosen set is the simplest one within one standard error
/// of the lowest cost. Windows are resampled in blocks.
pub(super) fn share(sets: &[Scored], name: &str) -> f64 {
    let sets: Vec<&Scored> = sets.iter().filter(|set| set.is_plausible).collect();
    let names: Vec<bool> = sets.iter().map(|set| set.names().contains(&name)).collect();
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
        hits += usize::from(names[chosen(&sets, &drawn)]);
    }
    hits as f64 / RESAMPLINGS as f64
}

/// Returns the index of the simplest set within one standard error of the lowest cost on some windows.
fn chosen(sets: &[&Scored], windows: &[usize]) -> usize {
    let count = windows.len() as f64;
    let cost = |set: &&Scored| {
        let sum: f64 = windows.iter().map(|&w| set.unseen[w]).sum();
        sum / count + set.fit.costs.prior / set.unseen.len() as f64
    };
    let costs: Vec<f64> = sets.iter().map(cost).collect();
    let best = (0..sets.len())
        .min_by(|&a, &b| costs[a].total_cmp(&costs[b]))
        .unwrap_or(0);
    let is_within = |i: &usize| {
        let difference = |w: usize| sets[*i].unseen[w] - sets[best].unseen[w];
        let mean = windows.iter().map(|&w| difference(w)).sum::<f64>() / count;
        let squares = windows.iter().map(|&w| (difference(w) - mean).powi(2));
        let error = (squares.sum::<f64>() / count.powi(2)).sqrt();
        costs[*i] - costs[best] <= error
    };
    (0..sets.len())
        .filter(is_within)
        .min_by(|&a, &b| {
            let by_complexity = sets[a].complexity().cmp(&sets[b].complexity());
            by_complexity.then(costs[a].total_cmp(&costs[b]))
        })
        .unwrap_or(best)
}
