//! Invalid rows: their position is not that of the device.

use super::frozen::frozen;
use super::saturated::{at_extremes, limits};
use super::spikes::spikes;
use crate::{Oddity, Run};

/// Removes the invalid rows of runs of one sensor. The result names them, and constant segments that may be the device's own.
pub(crate) fn leave_out(runs: &mut [Run]) -> Vec<Oddity> {
    // What one run shows to be a limit is one in all of them.
    let limits: Vec<f64> = runs.iter().flat_map(limits).collect();
    let mut oddities = Vec::new();
    for run in runs {
        let mut found = at_extremes(run, &limits);
        found.extend(frozen(run).into_iter().chain(spikes(run)));
        let mut is_valid = vec![true; run.len()];
        for (oddity, rows) in found {
            oddities.push(oddity);
            rows.into_iter()
                .flatten()
                .for_each(|row| is_valid[row] = false);
        }
        if is_valid.contains(&false) {
            let rows = (0..run.len()).filter(|&row| is_valid[row]);
            *run = run.rows(&rows.collect::<Vec<_>>());
        }
    }
    oddities
}
