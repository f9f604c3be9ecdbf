//! What the same motion brings at other times: the method of analogues (Lorenz, Atmospheric predictability as revealed by
//! naturally occurring analogues, 1969).

use super::bins::{Bins, Point};
use super::innovation::{Innovation, Place};
use rayon::prelude::*;

/// Innovations that are compared with one another, evenly taken: of more of them the nearest ones are hardly nearer.
const MOST: usize = 800;
/// Nearest ones whose mean counts; fewer than twice as many tell nothing.
const NEIGHBOURS: usize = 20;
/// Share of a session within which two are at the same time.
const SAME_TIME: f64 = 0.025;

/// What makes a motion the same, and what led to it.
const MOTION: [Place; 5] = [
    |i| i.position,
    |i| i.velocity,
    |i| i.acceleration,
    |i| i.input,
    |i| i.input_change,
];
/// How many of these are of the moment alone.
const OF_THE_MOMENT: usize = 4;

/// What of the gap comes again with the same motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Recurrence {
    /// Share of the gap, by the robust measure, that comes at moments whose motion brings none at other times.
    pub once: f64,
    /// Share of the missing acceleration that comes again with what led to the motion, and not with the motion alone.
    pub memory: f64,
}

impl Recurrence {
    /// Of some innovations in the order of time, with `bins` moments told apart.
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
        let now = neighbours(&all, &ranks[..OF_THE_MOMENT]);
        let led = neighbours(&all, &ranks);
        let known = |near: &[Vec<usize>]| known(near, |i| all[i].robust_missing());
        Self {
            once: once(&all, &now, bins),
            memory: (known(&led) - known(&now)).max(0.0),
        }
    }
}

/// Place of each value among all, from 0 to 1, the same for equal ones.
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

/// For each of some innovations, those of other times that are nearest by `ranks`.
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

/// Share of the squared values that the mean of their neighbours makes up for; below 0 where that is no help.
fn known(near: &[Vec<usize>], value: impl Fn(usize) -> f64) -> f64 {
    let all: f64 = (0..near.len()).map(|i| value(i).powi(2)).sum();
    let left = near
        .iter()
        .enumerate()
        .map(|(i, near)| (value(i) - mean(near, &value)).powi(2));
    1.0 - left.sum::<f64>() / all.max(f64::MIN_POSITIVE)
}

/// Surplus of the moments that carry more of the gap than the same motion does at other times.
fn once(all: &[Innovation], near: &[Vec<usize>], bins: usize) -> f64 {
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

    /// To and fro in 0.7 s, for 12 s; with what is missing as a function of time, of the phase and of the one shortly before.
    fn recurrence(missing: impl Fn(f64, f64, f64) -> f64) -> Recurrence {
        let innovation = |i: usize| {
            let session_s = 0.02 * i as f64;
            // The pace changes, so that the phase alone says what came before.
            let pace = if session_s < 6.0 { 1.0 } else { -1.0 };
            let phase = pace * TAU * session_s / 0.7;
            let missing = missing(session_s, phase.sin(), phase.cos());
            Innovation {
                session_s,
                position: phase.sin(),
                input: phase.sin(),
                input_change: pace * phase.cos(),
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
    fn what_goes_with_the_motion_comes_again() {
        let along = recurrence(|_, sin, _| 4.0 * sin);
        assert!(along.once < 0.1 && along.memory < 0.1, "{along:?}");
    }

    #[test]
    fn several_moments_are_told_from_what_comes_again() {
        let is_then = |s: f64| (1.0..1.5).contains(&s) || (5.0..5.4).contains(&s) || s > 11.5;
        let moments = recurrence(|s, _, _| if is_then(s) { 4.0 } else { 0.2 });
        assert!(moments.once > 0.7, "{moments:?}");
    }

    #[test]
    fn what_goes_with_a_change_has_a_memory() {
        let phase = recurrence(|s, _, cos| if s < 6.0 { 4.0 * cos } else { -4.0 * cos });
        assert!(phase.memory > 0.5 && phase.once < 0.2, "{phase:?}");
    }

    #[test]
    fn a_few_tell_nothing() {
        let few = [Innovation::default(); 2 * NEIGHBOURS - 1];
        assert_eq!(Recurrence::of(&few, 40), Recurrence::default());
        assert_eq!(Recurrence::of(&[], 40), Recurrence::default());
        let alike = [Innovation::default(); 2 * NEIGHBOURS];
        assert_eq!(Recurrence::of(&alike, 40), Recurrence::default());
    }
}
