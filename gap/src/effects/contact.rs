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
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::contact::KIND;
use std::ops::Range;

/// Sides to which it pushes back: what comes from below, what comes from above, and both, which is to hold.
const SIDES: [f64; 3] = [1.0, -1.0, 0.0];
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
/// Where it begins, between the ends of the motion while it is there, as screened for the missing torque.
const PLACES_SCREENED: [f64; 9] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85];

#[derive(Debug)]
pub(super) struct Contact;

impl Identification for Contact {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let contacts = pushes(e, &SIDES).into_iter().map(|push| {
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

    fn axis(&self) -> Axis {
        Axis::Time
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let Some((first, last)) = most_missing(path, target) else {
            return Vec::new();
        };
        let during = first..last + 1;
        let ends = path.position[during.clone()].iter();
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
            [l.min(*x), h.max(*x)]
        });
        let span = (high - low).max(f64::MIN_POSITIVE);
        let mut forms = vec![held(path, &during, [low, high])];
        for side in [-1.0, 1.0] {
            let places = PLACES_SCREENED.iter().map(|part| low + part * span);
            forms.extend(places.map(|at| pushed(path, &during, side, at, span)));
        }
        target.screened(forms, 2)
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

/// The same contact with each other side in its last stay.
pub(crate) fn otherwise(contact: &Term) -> Vec<Term> {
    let side = last_stay(contact) + SIDE;
    let others = SIDES
        .into_iter()
        .filter(|other| *other != contact.values[side]);
    others
        .map(|other| contact.begun(&[(side, other)]))
        .collect()
}

/// How many stays a contact has.
pub(crate) fn stays(contact: &Term) -> usize {
    let stays = (0..).take_while(|stay| contact.kind.event_place(*stay) < contact.values.len());
    stays.count()
}

/// Place of the last stay among the numbers of a contact.
fn last_stay(contact: &Term) -> usize {
    contact.kind.event_place(stays(contact) - 1)
}

/// When a contact comes and goes in its last stay, s of the session.
pub(crate) fn instants(contact: &Term) -> [f64; 2] {
    let stay = last_stay(contact);
    INSTANTS.map(|instant| contact.values[stay + instant])
}

/// Duration of all stays of a contact together, s.
pub(crate) fn there_s(contact: &Term) -> f64 {
    let stays = contact
        .kind
        .meanwhile(&contact.values)
        .into_iter()
        .flatten();
    stays.map(|[from_s, to_s]| (to_s - from_s).max(0.0)).sum()
}

/// The times between the instants of the last stay of two contacts, where those differ, s of the session.
pub(crate) fn moves(contact: &Term, moved: &Term) -> Vec<[f64; 2]> {
    let pairs = instants(contact).into_iter().zip(instants(moved));
    let between = pairs.map(|(a, b)| [a.min(b), a.max(b)]);
    between.filter(|[from_s, to_s]| from_s < to_s).collect()
}

/// The same contact whose last stay begins (0) or ends (1) later by some time.
pub(crate) fn moved(contact: &Term, which: usize, by_s: f64) -> Term {
    let instant = last_stay(contact) + INSTANTS[which];
    contact.begun(&[(instant, contact.values[instant] + by_s)])
}

/// The same contact with its last stay cut to either half.
pub(crate) fn halves(contact: &Term) -> [Term; 2] {
    let [from_s, to_s] = instants(contact);
    let half_s = 0.5 * (to_s - from_s);
    [moved(contact, 1, -half_s), moved(contact, 0, half_s)]
}

/// The first stay of a contact from before the first sample until after the last, with no instants to fit.
pub(crate) fn lasting(contact: &Term) -> Term {
    let [from, to] = INSTANTS.map(|instant| contact.kind.event_place(0) + instant);
    let mut contact = contact.begun(&[(from, f64::NEG_INFINITY), (to, f64::INFINITY)]);
    contact.free.retain(|c| c.parameter < from);
    contact.values.truncate(contact.kind.parameters.len());
    contact
}

/// The same contact with one more stay: during the run of windows that cost most together, and during the window that costs
/// most, at the positions there. None if it has as many stays as it may have.
pub(crate) fn returns(contact: &Term, series: &[Series], window_costs: &[f64]) -> Vec<Term> {
    if stays(contact) >= contact.kind.most_events() {
        return Vec::new();
    }
    let counts: Vec<usize> = series.iter().map(|s| s.windows.len()).collect();
    let again = stretches(&counts, window_costs).into_iter();
    let again = again.map(|(index, windows)| returning(contact, &series[index], windows));
    again.collect()
}

/// The same contact with one more stay during some windows of a series.
fn returning(contact: &Term, series: &Series, windows: Range<usize>) -> Term {
    let span = |positions: &[f64]| quantile(positions, 1.0) - quantile(positions, 0.0);
    let [first, last] = [windows.start, windows.end - 1].map(|w| &series.windows[w].samples);
    let rows = first.start..last.end;
    let positions = &series.position[rows.clone()];
    let push = Push {
        position: quantile(positions, 0.5),
        side: contact.values[last_stay(contact) + SIDE],
        stiffness: contact.values[STIFFNESS],
        damping: contact.values[DAMPING],
        from_s: series.session(rows.start),
        to_s: series.session(rows.end - 1),
        span: span(positions).max(LEAST_SPAN * span(&series.position)),
    };
    let mut contact = contact.clone();
    contact
        .free
        .extend(stay_coordinates(&push, contact.values.len()));
    let stay = [push.side, push.position, push.from_s, push.to_s];
    contact.values.extend(stay);
    contact
}

/// Something that holds during some rows, in which the motion lies between two ends.
fn held(path: &Path<'_>, during: &Range<usize>, [low, high]: [f64; 2]) -> Form {
    let span = (high - low).max(f64::MIN_POSITIVE);
    let middle = 0.5 * (low + high);
    let speed = path.scale.velocity;
    let instants_s = instants_s(path, during);
    let columns = vec![
        only(path, during, |i| -(path.position[i] - middle) / span),
        only(path, during, |i| -path.velocity[i] / speed),
        only(path, during, |_| 1.0),
    ];
    let form = Form::new(columns, move |c| {
        let k = c[0] / span;
        let at = middle + c[2] / k;
        stay([k, c[1] / speed], 0.0, at, instants_s)
    });
    form.searched(4).seldom()
}

/// Something that pushes back to one side from a place on during some rows, in which the motion has a span.
fn pushed(path: &Path<'_>, during: &Range<usize>, side: f64, at: f64, span: f64) -> Form {
    let speed = path.scale.velocity;
    let instants_s = instants_s(path, during);
    let depth = |i: usize| side * (path.position[i] - at);
    let push = only(path, during, |i| -side * depth(i).max(0.0) / span);
    let damp = only(path, during, |i| {
        if depth(i) > 0.0 {
            -path.velocity[i] / speed
        } else {
            0.0
        }
    });
    let form = Form::new(vec![push, damp], move |c| {
        stay([c[0] / span, c[1] / speed], side, at, instants_s)
    });
    form.searched(5).seldom().positive()
}

/// A value at each of some rows, and 0 at all others.
fn only(path: &Path<'_>, during: &Range<usize>, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let rows = 0..path.position.len();
    rows.map(|i| if during.contains(&i) { value(i) } else { 0.0 })
        .collect()
}

/// Instants of the first and the last of some rows, s of the session.
fn instants_s(path: &Path<'_>, during: &Range<usize>) -> [f64; 2] {
    [during.start, during.end - 1].map(|row| path.samples.session_s[row])
}

/// The numbers of a contact with a stiffness and a damping that stays once.
fn stay([stiffness, damping]: [f64; 2], side: f64, at: f64, [from_s, to_s]: [f64; 2]) -> Vec<f64> {
    let place = KIND.event_place(0);
    let values = [
        (STIFFNESS, stiffness.max(0.0)),
        (DAMPING, damping.max(0.0)),
        (place + SIDE, side),
        (place + POSITION, at),
        (place + INSTANTS[0], from_s),
        (place + INSTANTS[1], to_s),
    ];
    with_defaults(&KIND, &values)
}

/// First and last row of the stretch of time in which most more is missing than on the average.
fn most_missing(path: &Path<'_>, target: &Target<'_>) -> Option<(usize, usize)> {
    let energy = |i: usize| target.weight[i] * (target.torque[i].powi(2));
    let energy = |i: usize| energy(i).sqrt();
    let rows = 0..path.samples.len();
    let weighed: f64 = target.weight.iter().map(|w| w.sqrt()).sum();
    let mean = rows.map(energy).sum::<f64>() / weighed.max(f64::MIN_POSITIVE);
    let mut best: Option<(f64, usize, usize)> = None;
    for stretch in &path.samples.stretches {
        let (mut sum, mut from) = (0.0, stretch.rows.start);
        for row in stretch.rows.clone() {
            if sum <= 0.0 {
                (sum, from) = (0.0, row);
            }
            // Twice the mean, so that what is usual does not add up.
            sum += energy(row) - 2.0 * mean * target.weight[row].sqrt();
            if best.is_none_or(|(most, ..)| sum > most) {
                best = Some((sum, from, row));
            }
        }
    }
    best.filter(|(sum, from, to)| *sum > 0.0 && to > from)
        .map(|(_, from, to)| (from, to))
}
