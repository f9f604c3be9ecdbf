//! Compares the gap at an instant with the gap at other instants of similar motion. This is the method of analogues (Lorenz, Atmospheric
//! predictability as revealed by naturally occurring analogues, 1969).

use super::bins::{Bins, Point};
use super::innovation::{Coordinate, Innovation};
use rayon::prelude::*;

/// Largest number of innovations that are compared with each other. They are evenly spaced. With more of them the nearest neighbours are
/// hardly nearer.
const MOST: usize = 800;
/// Number of nearest neighbours whose mean is taken. At least twice as many innovations are required.
const NEIGHBOURS: usize = 20;
/// Two innovations closer in time than this share of the session count as simultaneous and are not compared.
const SAME_TIME: f64 = 0.025;

/// Coordinates that define a similar motion. The last one describes the motion shortly before.
const MOTION: [Coordinate; 5] = [
    |i| i.position,
    |i| i.velocity,
    |i| i.acceleration,
    |i| i.input,
    |i| i.input_change,
];
/// Number of the coordinates that describe the instant alone.
const OF_THE_MOMENT: usize = 4;

/// How far the gap recurs with the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Recurrence {
    /// Share of the gap, by the robust measure, at instants whose motion causes no gap at other times.
    pub non_recurring: f64,
    /// Share of the missing acceleration that the motion of the instant does not predict, and the motion together with its recent past
    /// does.
    pub memory: f64,
}

impl Recurrence {
    /// Evaluates innovations in the order of time, with `bins` bins of time.
    pub(super) fn of(all: &[Innovation], bins: usize) -> Self {
        let all: Vec<Innovation> = all
            .iter()
            .step_by(all.len().div_ceil(MOST).max(1))
            .copied()
            .collect();
        if all.len() < 2 * NEIGHBOURS {
            return Self::default();
        }
        let ranks = MOTION.map(|place| ranks(&all.iter().map(place).collect::<Vec<_>>()));
        let by_instant = neighbours(&all, &ranks[..OF_THE_MOMENT]);
        let by_past = neighbours(&all, &ranks);
        let predicted_share =
            |near: &[Vec<usize>]| predicted_share(near, |i| all[i].robust_missing());
        Self {
            non_recurring: non_recurring(&all, &by_instant, bins),
            memory: (predicted_share(&by_past) - predicted_share(&by_instant)).max(0.0),
        }
    }
}

/// Rank of each value, scaled to 0 to 1. Equal values have equal ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = |value: &f64| {
        let below = sorted.partition_point(|v| v < value);
        let up_to = sorted.partition_point(|v| v <= value);
        (below + up_to) as f64 / (2 * sorted.len()) as f64
    };
    values.iter().map(rank).collect()
}

/// For each innovation, the indices of its nearest neighbours by `ranks` among the innovations at other times.
fn neighbours(all: &[Innovation], ranks: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let span_s = all[all.len() - 1].session_s - all[0].session_s;
    let of = |i: usize| {
        let is_other =
            |j: &usize| (all[*j].session_s - all[i].session_s).abs() >= SAME_TIME * span_s;
        let distance = |j: usize| ranks.iter().map(|r| (r[i] - r[j]).powi(2)).sum::<f64>();
        let others = (0..all.len()).filter(is_other);
        let mut others: Vec<(f64, usize)> = others.map(|j| (distance(j), j)).collect();
        if others.len() > NEIGHBOURS {
            others
                .select_nth_unstable_by(NEIGHBOURS, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.truncate(NEIGHBOURS);
        }
        others.into_iter().map(|(_, j)| j).collect()
    };
    (0..all.len()).into_par_iter().map(of).collect()
}

fn mean(near: &[usize], value: impl Fn(usize) -> f64) -> f64 {
    near.iter().map(|&j| value(j)).sum::<f64>() / near.len().max(1) as f64
}

/// Share of the sum of squared values that the mean of the neighbours predicts. It is negative if the mean is a worse prediction than
/// zero.
fn predicted_share(near: &[Vec<usize>], value: impl Fn(usize) -> f64) -> f64 {
    let all: f64 = (0..near.len()).map(|i| value(i).powi(2)).sum();
    let left = near
        .iter()
        .enumerate()
        .map(|(i, near)| (value(i) - mean(near, &value)).powi(2));
    1.0 - left.sum::<f64>() / all.max(f64::MIN_POSITIVE)
}

/// Surplus of the bins of time that hold more of the gap than similar motion does at other times.
fn non_recurring(all: &[Innovation], near: &[Vec<usize>], bins: usize) -> f64 {
    let density = |j: usize| all[j].robust() / all[j].samples;
    let points = all
        .iter()
        .zip(near)
        .enumerate()
        .map(|(index, (i, near))| Point {
            at: i.session_s,
            index,
            block: i.window,
            weight: i.samples * mean(near, density),
            excess: i.robust(),
        });
    Bins::new(points.collect(), bins).map_or(0.0, |bins| bins.confirmed())
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    /// A sinusoidal motion with a period of 0.7 s, over 12 s. The missing acceleration is a function of the time and of the sine and
    /// cosine of the phase.
    fn recurrence(missing: impl Fn(f64, f64, f64) -> f64) -> Recurrence {
        let innovation = |i: usize| {
            let session_s = 0.02 * i as f64;
            // The direction of the phase reverses half way, so that the instant alone does not determine the motion shortly before.
            let phase_rate = if session_s < 6.0 { 1.0 } else { -1.0 };
            let phase = phase_rate * TAU * session_s / 0.7;
            let missing = missing(session_s, phase.sin(), phase.cos());
            Innovation {
                session_s,
                position: phase.sin(),
                input: phase.sin(),
                input_change: phase_rate * phase.cos(),
                samples: 1.0,
                excess: missing * missing,
                missing,
                ..Innovation::default()
            }
        };
        let all: Vec<Innovation> = (0..600).map(innovation).collect();
        Recurrence::of(&all, 40)
    }

    #[test]
    fn a_gap_that_is_a_function_of_the_motion_recurs() {
        let along = recurrence(|_, sin, _| 4.0 * sin);
        assert!(along.non_recurring < 0.1 && along.memory < 0.1, "{along:?}");
    }

    #[test]
    fn several_events_do_not_recur() {
        let is_event = |s: f64| (1.0..1.5).contains(&s) || (5.0..5.4).contains(&s) || s > 11.5;
        let events = recurrence(|s, _, _| if is_event(s) { 4.0 } else { 0.2 });
        assert!(events.non_recurring > 0.7, "{events:?}");
    }

    #[test]
    fn a_gap_that_depends_on_the_past_has_a_memory() {
        let phase = recurrence(|s, _, cos| if s < 6.0 { 4.0 * cos } else { -4.0 * cos });
        assert!(phase.memory > 0.5 && phase.non_recurring < 0.2, "{phase:?}");
    }

    #[test]
    fn too_few_innovations_give_no_result() {
        let few = [Innovation::default(); 2 * NEIGHBOURS - 1];
        assert_eq!(Recurrence::of(&few, 40), Recurrence::default());
        assert_eq!(Recurrence::of(&[], 40), Recurrence::default());
        let equal = [Innovation::default(); 2 * NEIGHBOURS];
        assert_eq!(Recurrence::of(&equal, 40), Recurrence::default());
    }
}
