//! Invalid rows: their position is not the position of the device.

use super::frozen::frozen;
use super::saturated::{at_extremes, limits};
use super::spikes::spikes;
use crate::{Oddity, Run};

/// Removes the invalid rows of all runs, which use the same sensor. Returns an oddity for each kind of invalid rows, and for
/// constant segments that can be real.
pub(crate) fn leave_out(runs: &mut [Run]) -> Vec<Oddity> {
    // A sensor limit that one run shows applies to all runs.
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
