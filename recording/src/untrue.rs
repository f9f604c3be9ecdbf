//! Rows whose position is not that of the device.

use crate::frozen::frozen;
use crate::saturated::{at_extremes, limits};
use crate::spikes::spikes;
use crate::{Oddity, Run};

/// Leaves out the rows of runs of one sensor in which it does not follow the device, and says what is odd about them and about
/// stays that may be the device's own.
pub(crate) fn leave_out(runs: &mut [Run]) -> Vec<Oddity> {
    // What one run shows to be a limit is one in all of them.
    let limits: Vec<f64> = runs.iter().flat_map(limits).collect();
    let mut oddities = Vec::new();
    for run in runs {
        let mut found = at_extremes(run, &limits);
        found.extend(frozen(run).into_iter().chain(spikes(run)));
        let mut is_true = vec![true; run.len()];
        for (oddity, rows) in found {
            oddities.push(oddity);
            rows.into_iter()
                .flatten()
                .for_each(|row| is_true[row] = false);
        }
        if is_true.contains(&false) {
            let rows = (0..run.len()).filter(|&row| is_true[row]);
            *run = run.rows(&rows.collect::<Vec<_>>());
        }
    }
    oddities
}
