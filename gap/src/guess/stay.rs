//! Something that pushes back or holds for a while: a stretch of time in which the nominal model fails.

use super::Evidence;
use super::regression::{moments, regress_in};
use crate::windows::statistics::{quantile, rms};
use std::ops::Range;

/// A window counts as hit from this much robust cost above the quiet ones.
const HIT_MARGIN: f64 = 0.7;
/// Quantile of the window costs that stands for the quiet ones.
const QUIET: f64 = 0.4;
/// What is there for longer than this share of the recording is no passing contact.
pub(crate) const LONGEST_SHARE: f64 = 0.5;

/// Least span of the positions meanwhile, over that of all.
pub(crate) const LEAST_SPAN: f64 = 0.02;
/// Least damping of a start, over what is usual.
const LEAST_DAMPING: f64 = 0.1;

/// Something that pushes back, and when.
#[derive(Clone, Copy)]
pub(crate) struct Stay {
    pub position: f64,
    /// +1 if it pushes back what comes from below, 0 if it holds.
    pub side: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub from_s: f64,
    pub to_s: f64,
    /// Of the positions meanwhile.
    pub span: f64,
}

/// What could push back to some `sides` in the stretch that is worst.
pub(crate) fn stays(e: &Evidence<'_>, sides: &[f64]) -> Vec<Stay> {
    worst(e)
        .into_iter()
        .flat_map(|(series, windows)| stays_during(e, sides, series, windows))
        .collect()
}

/// The stretches of windows in which the model is worst, by index of the series.
fn worst(e: &Evidence<'_>) -> Vec<(usize, Range<usize>)> {
    let counts: Vec<usize> = e.series.iter().map(|s| s.windows.len()).collect();
    stretches(&counts, e.window_costs)
}

/// Missing torque that is more than chance, from its rms.
fn strongly(rms_nm: f64) -> f64 {
    1.5 * rms_nm
}

/// The times in which something may have come and gone, s of the session: of each of the worst stretches, from the first to the last
/// sample with much missing torque, and the whole stretch.
pub(crate) fn worst_times(e: &Evidence<'_>) -> Vec<[f64; 2]> {
    let edges = worst(e)
        .into_iter()
        .flat_map(|(series, windows)| Worst::of(e, series, &windows).edges);
    edges.collect()
}

/// A stretch of time in which much torque is missing.
struct Worst {
    rows: Range<usize>,
    /// From the first to the last sample that misses much, and all of it, s of the session.
    edges: [[f64; 2]; 2],
    /// Rms of the torque that is missing in it, and in the whole series, N m.
    missing_nm: f64,
    usual_nm: f64,
}

impl Worst {
    fn of(e: &Evidence<'_>, series: usize, windows: &Range<usize>) -> Self {
        let data = &e.series[series];
        let [first, last] = [windows.start, windows.end - 1].map(|w| &data.windows[w].samples);
        let rows = first.start..last.end;
        let all = &e.motions[series].missing_nm;
        let missing = &all[rows.clone()];
        let rms_of = |values: &[f64]| {
            let known = values.iter().copied().filter(|m| m.is_finite());
            rms(&known.collect::<Vec<_>>())
        };
        let usual_nm = rms_of(all);
        let strong = |m: &f64| m.abs() > strongly(usual_nm);
        let from = missing.iter().position(strong).unwrap_or(0);
        let to = missing.iter().rposition(strong);
        let to = to.unwrap_or(missing.len() - 1);
        let ends = [rows.start + from, (rows.start + to + 1).min(rows.end - 1)];
        let edges = [ends, [rows.start, rows.end - 1]];
        Self {
            edges: edges.map(|ends| ends.map(|row| data.session(row))),
            missing_nm: rms_of(missing),
            usual_nm,
            rows,
        }
    }
}

fn stays_during(
    e: &Evidence<'_>,
    sides: &[f64],
    series: usize,
    windows: Range<usize>,
) -> Vec<Stay> {
    let Worst {
        rows,
        edges,
        missing_nm,
        usual_nm: quiet,
    } = Worst::of(e, series, &windows);
    let motion = &e.motions[series];
    let positions: Vec<f64> = rows.clone().map(|i| motion.position[i]).collect();
    let strength = missing_nm.max(0.2 * e.scales.torque);
    let span =
        (quantile(&positions, 1.0) - quantile(&positions, 0.0)).max(LEAST_SPAN * e.scales.span());
    let stiffness = 3.0 * strength / span;
    let mut all = Vec::new();
    for &side in sides {
        let during = edges.map(|[from_s, to_s]| Stay {
            position: 0.0,
            side,
            stiffness,
            damping: 0.3 * (stiffness * e.device.mechanics.inertia).sqrt(),
            from_s,
            to_s,
            span,
        });
        let least_nm = if side == 0.0 { 0.0 } else { strongly(quiet) };
        all.extend(during.iter().filter_map(|stay| stay.regressed(e, least_nm)));
        for share in [0.15, 0.5, 0.85] {
            let position = quantile(&positions, share);
            all.extend(during.map(|stay| Stay { position, ..stay }));
        }
    }
    all
}

impl Stay {
    /// The same where the torque that is missing meanwhile, `least_nm` to its side, says that it is.
    fn regressed(self, e: &Evidence<'_>, least_nm: f64) -> Option<Self> {
        let pushed = moments(e).filter(|m| {
            let meanwhile = m.session_s >= self.from_s && m.session_s <= self.to_s;
            meanwhile && -self.side * m.missing_nm >= least_nm
        });
        let (found, _) = regress_in(pushed, |m| [-m.position, -m.velocity, 1.0])?;
        let [stiffness, damping, pull] = found;
        (stiffness > 0.0).then(|| Self {
            position: pull / stiffness,
            stiffness,
            damping: damping.max(LEAST_DAMPING * self.damping),
            ..self
        })
    }
}

/// The run of windows with the largest sum of cost above the quiet level (Kadane's algorithm), if it is short and stands
/// out, and the worst window: by index of the series and windows of it, of which each series has its count.
pub(crate) fn stretches(counts: &[usize], costs: &[f64]) -> Vec<(usize, Range<usize>)> {
    let finite: Vec<f64> = costs.iter().copied().filter(|c| c.is_finite()).collect();
    let quiet = quantile(&finite, QUIET);
    let mut best: Option<(f64, usize, Range<usize>)> = None;
    let mut worst: Option<(f64, usize, Range<usize>)> = None;
    let mut base = 0;
    for (index, &count) in counts.iter().enumerate() {
        let (mut sum, mut start) = (0.0, 0);
        for w in 0..count {
            let cost = Some(costs[base + w]).filter(|c| c.is_finite());
            let cost = cost.unwrap_or(quiet);
            if worst.as_ref().is_none_or(|(most, ..)| cost > *most) {
                worst = Some((cost, index, w..w + 1));
            }
            sum += cost - quiet - HIT_MARGIN;
            if sum <= 0.0 {
                (sum, start) = (0.0, w + 1);
            } else if best.as_ref().is_none_or(|(most, ..)| sum > *most) {
                best = Some((sum, index, start..w + 1));
            }
        }
        base += count;
    }
    let is_short = |windows: &Range<usize>| windows.len() as f64 <= LONGEST_SHARE * base as f64;
    let Some((_, series, windows)) = best.filter(|(.., windows)| is_short(windows)) else {
        return Vec::new();
    };
    let worst = worst.map(|(_, series, window)| (series, window));
    let best = (series, windows);
    let worst = worst.filter(|worst| *worst != best);
    core::iter::once(best).chain(worst).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_is_looked_for_where_most_is_missing_and_where_it_is_worst() {
        let mut costs = [0.7; 40];
        costs[5..11].fill(4.0);
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (0, 5..6)]);
        costs[33] = 12.0;
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (1, 13..14)]);
        costs[33] = 60.0;
        assert_eq!(stretches(&[20, 20], &costs), [(1, 13..14)]);
    }

    #[test]
    fn what_is_missing_most_of_the_time_is_no_contact() {
        let costs = [[0.7; 10], [4.0; 10], [4.0; 10]].concat();
        assert_eq!(stretches(&[30], &costs), []);
    }
}
