//! Something outside that pushes back or holds for a while: a stretch of time in which the nominal model fails.

use super::Evidence;
use super::regression::{moments, regress_in};
use super::start::{linear, log, term};
use crate::fit::hypothesis::{Coordinate, Term};
use crate::windows::motion::{quantile, rms};
use crate::windows::series::Series;
use host_sim::effects::Kind;
use std::ops::Range;

/// A window counts as hit from this much robust cost above the quiet ones.
const HIT_MARGIN: f64 = 0.7;
/// Quantile of the window costs that stands for the quiet ones.
const QUIET: f64 = 0.4;
/// What is there for longer than this share of the recording is no passing contact.
pub(crate) const LONGEST_SHARE: f64 = 0.5;

/// What pushes back or holds: against motion up, down, and both.
const HAND: [f64; 3] = [1.0, -1.0, 0.0];
/// Places among its numbers of the stiffness and of the damping.
pub(crate) const STIFFNESS: usize = 0;
const DAMPING: usize = 1;
/// And after that of a stay those of the side, of the position, and of when it comes and goes.
const SIDE: usize = 0;
const POSITION: usize = 1;
const INSTANTS: [usize; 2] = [2, 3];
/// Scales of where it is and of the instants at which it comes and goes, over the span of the motion and the time meanwhile.
const PLACE_SCALE: f64 = 0.1;
const TIME_SCALE: f64 = 0.1;

/// Least span of the positions meanwhile, over that of all.
const LEAST_SPAN: f64 = 0.02;
/// Least damping of a start, over what is usual.
const LEAST_DAMPING: f64 = 0.1;

/// Something that pushes back, and when.
#[derive(Clone, Copy)]
pub(super) struct Push {
    pub position: f64,
    /// +1 if it pushes back what comes from below, 0 if it holds.
    pub side: f64,
    pub stiffness: f64,
    pub damping: f64,
    from_s: f64,
    to_s: f64,
    /// Of the positions meanwhile.
    pub span: f64,
}

/// As contacts of that time.
pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let contacts = pushes(e, &HAND).into_iter().map(|push| {
        let mut free = vec![log(STIFFNESS, push.stiffness), log(DAMPING, push.damping)];
        free.extend(push.stay(kind.event_place(0)));
        let side = kind.event_place(0) + SIDE;
        term(kind, free, &[(side, push.side)])
    });
    contacts.collect()
}

/// The same hand as it would push back or hold otherwise in its last stay.
pub(crate) fn otherwise(hand: &Term) -> Vec<Term> {
    let side = last_stay(hand) + SIDE;
    let others = HAND.into_iter().filter(|other| *other != hand.values[side]);
    others.map(|other| with(hand, side, other)).collect()
}

/// How often a hand comes.
pub(crate) fn stays(hand: &Term) -> usize {
    let stays = (0..).take_while(|stay| hand.kind.event_place(*stay) < hand.values.len());
    stays.count()
}

/// Place of the last stay among the numbers of a hand.
fn last_stay(hand: &Term) -> usize {
    hand.kind.event_place(stays(hand) - 1)
}

/// When a hand comes and goes in its last stay, s of the session.
pub(crate) fn instants(hand: &Term) -> [f64; 2] {
    let stay = last_stay(hand);
    INSTANTS.map(|instant| hand.values[stay + instant])
}

/// How long a hand is there in all its stays, s.
pub(crate) fn there_s(hand: &Term) -> f64 {
    let stays = hand.kind.meanwhile(&hand.values).into_iter().flatten();
    stays.map(|[from_s, to_s]| (to_s - from_s).max(0.0)).sum()
}

/// The times between the instants of the last stay of two hands, where those differ, s of the session.
pub(crate) fn moves(hand: &Term, moved: &Term) -> Vec<[f64; 2]> {
    let pairs = instants(hand).into_iter().zip(instants(moved));
    let between = pairs.map(|(a, b)| [a.min(b), a.max(b)]);
    between.filter(|[from_s, to_s]| from_s < to_s).collect()
}

/// The same hand that comes (0) to its last stay, or goes (1), at another instant.
pub(crate) fn moved(hand: &Term, which: usize, by_s: f64) -> Term {
    let instant = last_stay(hand) + INSTANTS[which];
    with(hand, instant, hand.values[instant] + by_s)
}

/// The same hand that is there in either half of its last stay alone.
pub(crate) fn halves(hand: &Term) -> [Term; 2] {
    let [from_s, to_s] = instants(hand);
    let half_s = 0.5 * (to_s - from_s);
    [moved(hand, 1, -half_s), moved(hand, 0, half_s)]
}

/// The first stay of a hand from before the first sample until after the last, with no instants to fit.
pub(crate) fn lasting(hand: &Term) -> Term {
    let [from, to] = INSTANTS.map(|instant| hand.kind.event_place(0) + instant);
    let mut hand = with(hand, from, f64::NEG_INFINITY);
    hand = with(&hand, to, f64::INFINITY);
    hand.free.retain(|c| c.parameter < from);
    hand.values.truncate(hand.kind.parameters.len());
    hand
}

/// The same hand that comes once more, where it stood, when most is missing by the costs of the windows of some series and when
/// it is worst; none if it has come as often as it may.
pub(crate) fn returns(hand: &Term, series: &[Series], window_costs: &[f64]) -> Vec<Term> {
    if stays(hand) >= hand.kind.most_events() {
        return Vec::new();
    }
    let counts: Vec<usize> = series.iter().map(|s| s.windows.len()).collect();
    let again = stretches(&counts, window_costs).into_iter();
    let again = again.map(|(index, windows)| returning(hand, &series[index], windows));
    again.collect()
}

/// The same hand that comes once more, where it stood, for some windows of a series.
fn returning(hand: &Term, series: &Series, windows: Range<usize>) -> Term {
    let span = |positions: &[f64]| quantile(positions, 1.0) - quantile(positions, 0.0);
    let [first, last] = [windows.start, windows.end - 1].map(|w| &series.windows[w].samples);
    let rows = first.start..last.end;
    let positions = &series.position[rows.clone()];
    let push = Push {
        position: quantile(positions, 0.5),
        side: hand.values[last_stay(hand) + SIDE],
        stiffness: hand.values[STIFFNESS],
        damping: hand.values[DAMPING],
        from_s: series.session(rows.start),
        to_s: series.session(rows.end - 1),
        span: span(positions).max(LEAST_SPAN * span(&series.position)),
    };
    let mut hand = hand.clone();
    hand.free.extend(push.stay(hand.values.len()));
    let stay = [push.side, push.position, push.from_s, push.to_s];
    hand.values.extend(stay);
    hand
}

fn with(hand: &Term, parameter: usize, value: f64) -> Term {
    let mut hand = hand.clone();
    hand.values[parameter] = value;
    for coordinate in hand.free.iter_mut().filter(|c| c.parameter == parameter) {
        coordinate.start = value;
    }
    hand
}

/// What could push back to some `sides` in the stretch that is worst.
pub(super) fn pushes(e: &Evidence<'_>, sides: &[f64]) -> Vec<Push> {
    let counts: Vec<usize> = e.series.iter().map(|s| s.windows.len()).collect();
    stretches(&counts, e.window_costs)
        .into_iter()
        .flat_map(|(series, windows)| pushes_during(e, sides, series, windows))
        .collect()
}

/// Missing torque that is more than chance, from its rms.
fn strongly(rms_nm: f64) -> f64 {
    1.5 * rms_nm
}

fn pushes_during(
    e: &Evidence<'_>,
    sides: &[f64],
    series: usize,
    windows: Range<usize>,
) -> Vec<Push> {
    let data = &e.series[series];
    let rows = data.windows[windows.start].samples.start..data.windows[windows.end - 1].samples.end;
    let motion = &e.motions[series];
    let missing: Vec<f64> = rows.clone().map(|i| motion.missing_nm[i]).collect();
    let known: Vec<f64> = missing.iter().copied().filter(|m| m.is_finite()).collect();
    let quiet = rms(&motion
        .missing_nm
        .iter()
        .copied()
        .filter(|m| m.is_finite())
        .collect::<Vec<_>>());
    // The torque is missing while it is there: from the first to the last sample that shows it.
    let strong = |m: f64| m.abs() > strongly(quiet);
    let from = missing.iter().position(|m| strong(*m)).unwrap_or(0);
    let to = missing
        .iter()
        .rposition(|m| strong(*m))
        .unwrap_or(missing.len() - 1);
    let edges = [
        [
            data.session(rows.start + from),
            data.session((rows.start + to + 1).min(rows.end - 1)),
        ],
        [data.session(rows.start), data.session(rows.end - 1)],
    ];
    let positions: Vec<f64> = rows.clone().map(|i| motion.position[i]).collect();
    let strength = rms(&known).max(0.2 * e.scales.torque);
    let span =
        (quantile(&positions, 1.0) - quantile(&positions, 0.0)).max(LEAST_SPAN * e.scales.span());
    let stiffness = 3.0 * strength / span;
    let mut all = Vec::new();
    for &side in sides {
        let during = edges.map(|[from_s, to_s]| Push {
            position: 0.0,
            side,
            stiffness,
            damping: 0.3 * (stiffness * e.device.mechanics.inertia).sqrt(),
            from_s,
            to_s,
            span,
        });
        let least_nm = if side == 0.0 { 0.0 } else { strongly(quiet) };
        all.extend(during.iter().filter_map(|push| push.regressed(e, least_nm)));
        for share in [0.15, 0.5, 0.85] {
            let position = quantile(&positions, share);
            all.extend(during.map(|push| Push { position, ..push }));
        }
    }
    all
}

impl Push {
    /// What is free of a stay at some place.
    fn stay(&self, place: usize) -> [Coordinate; 3] {
        let time_scale = TIME_SCALE * (self.to_s - self.from_s);
        [
            linear(place + POSITION, self.position, PLACE_SCALE * self.span),
            linear(place + INSTANTS[0], self.from_s, time_scale),
            linear(place + INSTANTS[1], self.to_s, time_scale),
        ]
    }

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
fn stretches(counts: &[usize], costs: &[f64]) -> Vec<(usize, Range<usize>)> {
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
    fn a_hand_is_looked_for_where_most_is_missing_and_where_it_is_worst() {
        let mut costs = [0.7; 40];
        costs[5..11].fill(4.0);
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (0, 5..6)]);
        costs[33] = 12.0;
        assert_eq!(stretches(&[20, 20], &costs), [(0, 5..11), (1, 13..14)]);
        costs[33] = 60.0;
        assert_eq!(stretches(&[20, 20], &costs), [(1, 13..14)]);
    }

    #[test]
    fn what_is_missing_most_of_the_time_is_no_hand() {
        let costs = [[0.7; 10], [4.0; 10], [4.0; 10]].concat();
        assert_eq!(stretches(&[30], &costs), []);
    }
}
