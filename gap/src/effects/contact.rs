//! Something outside that pushes back or holds for a while.

use super::end_stop::EndStop;
use super::gravity::Gravity;
use super::identification::Identification;
use super::phrase::{Found, Part, Phrase};
use super::spring::Spring;
use super::torque_offset::TorqueOffset;
use crate::diagnosis::Estimate;
use crate::guess::Evidence;
use crate::guess::push::{LEAST_SPAN, Push, pushes, stretches};
use crate::guess::start::{linear, log, term};
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::contact::KIND;
use std::ops::Range;

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

#[derive(Debug)]
pub(super) struct Contact;

impl Identification for Contact {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let contacts = pushes(e, &HAND).into_iter().map(|push| {
            let mut free = vec![log(STIFFNESS, push.stiffness), log(DAMPING, push.damping)];
            free.extend(stay_coordinates(&push, KIND.event_place(0)));
            let side = KIND.event_place(0) + SIDE;
            term(&KIND, free, &[(side, push.side)])
        });
        contacts.collect()
    }

    fn is_local(&self) -> bool {
        true
    }

    fn comes_and_goes(&self) -> bool {
        true
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset, &Gravity, &Spring, &EndStop]
    }

    fn noun(&self) -> &'static str {
        "contact with something outside"
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.value("side") {
            Some(0.0) => "something outside that holds it from {from} to {to}",
            _ => "something outside that pushes back from {from} to {to}",
        }
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        if found.estimate("from").is_none() {
            let times = found.count("from");
            return Phrase::of(format!("something outside that comes {times} times"));
        }
        let lasts = found.value("to").zip(found.value("from"));
        let lasts = lasts.map_or(0.0, |(to, from)| (to - from).abs());
        let said = |name: &str, at: &Estimate| match name {
            "from" | "to" if lasts.is_normal() => Part::Instant {
                at: at.clone(),
                lasts,
            },
            _ => Part::Number(at.clone()),
        };
        let filled = found.filled_by(self.template(found), said);
        filled.unwrap_or_else(|| Phrase::of(self.noun()))
    }
}

/// What is free of a stay whose parameters begin at some place.
fn stay_coordinates(push: &Push, place: usize) -> [Coordinate; 3] {
    let time_scale = TIME_SCALE * (push.to_s - push.from_s);
    [
        linear(place + POSITION, push.position, PLACE_SCALE * push.span),
        linear(place + INSTANTS[0], push.from_s, time_scale),
        linear(place + INSTANTS[1], push.to_s, time_scale),
    ]
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
    hand.free.extend(stay_coordinates(&push, hand.values.len()));
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
