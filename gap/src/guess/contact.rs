//! Start values of a contact that acts for a limited time: the interval in which the nominal model fails most.

use super::Evidence;
use super::regression::{moments, regress_in};
use crate::windows::statistics::{quantile, rms};
use std::ops::Range;

/// Robust cost above the typical window from which a window counts as affected.
const AFFECTED_MARGIN: f64 = 0.7;
/// Quantile of the window costs that defines the cost of a typical window.
const TYPICAL: f64 = 0.4;
/// Share of the recording beyond which an effect is not a temporary contact.
pub(crate) const LONGEST_SHARE: f64 = 0.5;

/// Least assumed range of the positions during the contact, as a share of the range of the recording.
pub(crate) const LEAST_SPAN: f64 = 0.02;
/// Least damping of a start, relative to the damping of a start without regression.
const LEAST_DAMPING: f64 = 0.1;

/// Start values of a contact, with the interval in which it acts.
#[derive(Clone, Copy)]
pub(crate) struct ContactStart {
    pub position: f64,
    /// +1 if it pushes back a motion from below, -1 from above, 0 if it holds in both directions.
    pub side: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub from_s: f64,
    pub to_s: f64,
    /// Range of the positions during the contact.
    pub span: f64,
}

/// Starts of a contact with each of `sides`, in the intervals where the model is worst.
pub(crate) fn contact_starts(e: &Evidence<'_>, sides: &[f64]) -> Vec<ContactStart> {
    worst(e)
        .into_iter()
        .flat_map(|(series, windows)| contact_starts_during(e, sides, series, windows))
        .collect()
}

/// Ranges of windows in which the model is worst, with the index of their series.
fn worst(e: &Evidence<'_>) -> Vec<(usize, Range<usize>)> {
    let counts: Vec<usize> = e.series.iter().map(|s| s.windows.len()).collect();
    stretches(&counts, e.window_costs)
}

/// Missing torque that counts as significant, from the rms of the missing torque, N m.
fn significant_nm(rms_nm: f64) -> f64 {
    1.5 * rms_nm
}

/// Intervals in which a temporary effect may have acted, s of the session. Each of the worst ranges gives two: from the first to the last
/// sample with a significant missing torque, and the whole range.
pub(crate) fn worst_intervals(e: &Evidence<'_>) -> Vec<[f64; 2]> {
    let edges = worst(e)
        .into_iter()
        .flat_map(|(series, windows)| WorstInterval::of(e, series, &windows).edges);
    edges.collect()
}

/// An interval with a large missing torque.
struct WorstInterval {
    rows: Range<usize>,
    /// Interval from the first to the last sample with a significant missing torque, and the whole interval, s of the session.
    edges: [[f64; 2]; 2],
    /// Rms of the missing torque in the interval and in the whole series, N m.
    missing_nm: f64,
    usual_nm: f64,
}

impl WorstInterval {
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
        let strong = |m: &f64| m.abs() > significant_nm(usual_nm);
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

fn contact_starts_during(
    e: &Evidence<'_>,
    sides: &[f64],
    series: usize,
    windows: Range<usize>,
) -> Vec<ContactStart> {
    let WorstInterval {
        rows,
        edges,
        missing_nm,
        usual_nm: typical,
    } = WorstInterval::of(e, series, &windows);
    let motion = &e.motions[series];
    let positions: Vec<f64> = rows.clone().map(|i| motion.position[i]).collect();
    let strength = missing_nm.max(0.2 * e.scales.torque);
    let span =
        (quantile(&positions, 1.0) - quantile(&positions, 0.0)).max(LEAST_SPAN * e.scales.span());
    let stiffness = 3.0 * strength / span;
    let mut all = Vec::new();
    for &side in sides {
        let during = edges.map(|[from_s, to_s]| ContactStart {
            position: 0.0,
            side,
            stiffness,
            damping: 0.3 * (stiffness * e.device.mechanics.inertia).sqrt(),
            from_s,
            to_s,
            span,
        });
        let least_nm = if side == 0.0 {
            0.0
        } else {
            significant_nm(typical)
        };
        all.extend(
            during
                .iter()
                .filter_map(|start| start.regressed(e, least_nm)),
        );
        for share in [0.15, 0.5, 0.85] {
            let position = quantile(&positions, share);
            all.extend(during.map(|start| ContactStart { position, ..start }));
        }
    }
    all
}

impl ContactStart {
    /// Start values by regression of the missing torque in the interval, at the instants where it is at least `least_nm` towards the side
    /// of the contact. Returns `None` if the stiffness is not positive.
    fn regressed(self, e: &Evidence<'_>, least_nm: f64) -> Option<Self> {
        let pushed = moments(e).filter(|m| {
            let is_during = m.session_s >= self.from_s && m.session_s <= self.to_s;
            is_during && -self.side * m.missing_nm >= least_nm
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

/// The range of windows with the largest sum of costs above the typical cost (Kadane's algorithm), and the single worst window. Each
/// comes with the index of its series. The result is empty if the range is longer than [`LONGEST_SHARE`] of the windows. `counts` holds
/// the number of windows of each series.
pub(crate) fn stretches(counts: &[usize], costs: &[f64]) -> Vec<(usize, Range<usize>)> {
    let finite: Vec<f64> = costs.iter().copied().filter(|c| c.is_finite()).collect();
    let typical = quantile(&finite, TYPICAL);
    let mut best: Option<(f64, usize, Range<usize>)> = None;
    let mut worst: Option<(f64, usize, Range<usize>)> = None;
    let mut base = 0;
    for (index, &count) in counts.iter().enumerate() {
        let (mut sum, mut start) = (0.0, 0);
        for w in 0..count {
            let cost = Some(costs[base + w]).filter(|c| c.is_finite());
            let cost = cost.unwrap_or(typical);
            if worst.as_ref().is_none_or(|(most, ..)| cost > *most) {
                worst = Some((cost, index, w..w + 1));
            }
            sum += cost - typical - AFFECTED_MARGIN;
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
    fn a_contact_is_searched_in_the_worst_range_and_in_the_worst_window() {
        let mut costs = [0.7; 40];
        costs[5..11].fill(4.0);
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (0, 5..6)]);
        costs[33] = 12.0;
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (1, 13..14)]);
        costs[33] = 60.0;
        assert_eq!(stretches(&[20, 20], &costs), [(1, 13..14)]);
    }

    #[test]
    fn an_error_during_most_of_the_time_is_no_contact() {
        let costs = [[0.7; 10], [4.0; 10], [4.0; 10]].concat();
        assert_eq!(stretches(&[30], &costs), []);
    }
}
