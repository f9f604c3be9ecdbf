//! A contact with an external object that pushes back or holds for a limited time.

use super::end_stop::EndStop;
use super::episode::{Episode, instant_coordinates, last_occurrence, phrase_between};
use super::gravity::Gravity;
use super::identification::Identification;
use super::phrase::{Found, Phrase};
use super::push::Push;
use super::spring::Spring;
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::contact::{ContactStart, LEAST_SPAN, contact_starts};
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

/// Sides of a contact: 1 pushes back a motion from below, −1 one from above, and 0 holds in both directions.
const SIDES: [f64; 3] = [1.0, -1.0, 0.0];
/// Indices of the parameters stiffness and damping.
const STIFFNESS: usize = 0;
const DAMPING: usize = 1;
/// Offsets of the parameters of an occurrence: side, position, and begin and end.
const SIDE: usize = 0;
const POSITION: usize = 1;
const INSTANTS: [usize; 2] = [2, 3];
/// Scale of the coordinate of the position, as a share of the range of the motion during the contact.
const POSITION_SCALE: f64 = 0.1;
/// Positions of a one-sided contact that are screened for the missing torque, as shares of the range of the motion during the contact.
const POSITIONS_SCREENED: [f64; 9] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85];

#[derive(Debug)]
pub(super) struct Contact;

impl Identification for Contact {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let contacts = contact_starts(e, &SIDES).into_iter().map(|start| {
            let mut free = vec![log(STIFFNESS, start.stiffness), log(DAMPING, start.damping)];
            free.extend(contact_coordinates(&start, KIND.event_place(0)));
            let side = KIND.event_place(0) + SIDE;
            term(&KIND, free, &[(side, start.side)])
        });
        contacts.collect()
    }

    fn is_local(&self) -> bool {
        true
    }

    fn episode(&self) -> Option<&dyn Episode> {
        Some(self)
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset, &Gravity, &Spring, &EndStop, &Push]
    }

    fn axis(&self) -> Axis {
        Axis::Time
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let Some((first, last)) = target.most_missing(path) else {
            return Vec::new();
        };
        let during = first..last + 1;
        let ends = path.position[during.clone()].iter();
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
            [l.min(*x), h.max(*x)]
        });
        let span = (high - low).max(f64::MIN_POSITIVE);
        let mut forms = vec![holding_form(path, &during, [low, high])];
        for side in [-1.0, 1.0] {
            let places = POSITIONS_SCREENED.iter().map(|part| low + part * span);
            forms.extend(places.map(|at| pushing_form(path, &during, side, at, span)));
        }
        target.screened(forms, 2)
    }

    fn noun(&self) -> &'static str {
        "contact with something outside"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque is there between two instants and not before or after. A hard stop is there all the time. Repeat the session without touching the device."
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
        phrase_between(found, self.template(found)).unwrap_or_else(|| Phrase::of(self.noun()))
    }
}

impl Episode for Contact {
    fn strength(&self) -> usize {
        STIFFNESS
    }

    fn other_forms(&self, contact: &Term) -> Vec<Term> {
        let side = last_occurrence(contact) + SIDE;
        let others = SIDES
            .into_iter()
            .filter(|other| *other != contact.values[side]);
        others
            .map(|other| contact.starting_at(&[(side, other)]))
            .collect()
    }

    fn with_occurrence(&self, contact: &Term, series: &Series, windows: Range<usize>) -> Term {
        let span = |positions: &[f64]| quantile(positions, 1.0) - quantile(positions, 0.0);
        let [first, last] = [windows.start, windows.end - 1].map(|w| &series.windows[w].samples);
        let rows = first.start..last.end;
        let positions = &series.position[rows.clone()];
        let start = ContactStart {
            position: quantile(positions, 0.5),
            side: contact.values[last_occurrence(contact) + SIDE],
            stiffness: contact.values[STIFFNESS],
            damping: contact.values[DAMPING],
            from_s: series.session(rows.start),
            to_s: series.session(rows.end - 1),
            span: span(positions).max(LEAST_SPAN * span(&series.position)),
        };
        let mut contact = contact.clone();
        let place = contact.values.len();
        contact.free.extend(contact_coordinates(&start, place));
        let occurrence = [start.side, start.position, start.from_s, start.to_s];
        contact.values.extend(occurrence);
        contact
    }
}

/// Coordinates of position, begin and end of a contact, whose parameters start at index `first`.
fn contact_coordinates(start: &ContactStart, first: usize) -> Vec<Coordinate> {
    let position = linear(
        first + POSITION,
        start.position,
        POSITION_SCALE * start.span,
    );
    let instants = instant_coordinates(INSTANTS, [start.from_s, start.to_s], first);
    core::iter::once(position).chain(instants).collect()
}

/// The form of a contact that holds in both directions during some rows, in which the motion lies between two positions.
fn holding_form(path: &Path<'_>, during: &Range<usize>, [low, high]: [f64; 2]) -> Form {
    let span = (high - low).max(f64::MIN_POSITIVE);
    let middle = 0.5 * (low + high);
    let speed = path.scale.velocity;
    let instants_s = instants_s(path, during);
    let columns = vec![
        column_during(path, during, |i| -(path.position[i] - middle) / span),
        column_during(path, during, |i| -path.velocity[i] / speed),
        column_during(path, during, |_| 1.0),
    ];
    let form = Form::new(columns, move |c| {
        let k = c[0] / span;
        let at = middle + c[2] / k;
        parameters([k, c[1] / speed], 0.0, at, instants_s)
    });
    form.searched(4).seldom()
}

/// The form of a contact that pushes back from a position on during some rows. `span` is the range of the motion in these rows.
fn pushing_form(path: &Path<'_>, during: &Range<usize>, side: f64, at: f64, span: f64) -> Form {
    let speed = path.scale.velocity;
    let instants_s = instants_s(path, during);
    let depth = |i: usize| side * (path.position[i] - at);
    let push = column_during(path, during, |i| -side * depth(i).max(0.0) / span);
    let damp = column_during(path, during, |i| {
        if depth(i) > 0.0 {
            -path.velocity[i] / speed
        } else {
            0.0
        }
    });
    let form = Form::new(vec![push, damp], move |c| {
        parameters([c[0] / span, c[1] / speed], side, at, instants_s)
    });
    form.searched(5).seldom().positive()
}

/// A column with a value at each of some rows, and 0 at all others.
fn column_during(path: &Path<'_>, during: &Range<usize>, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let rows = 0..path.position.len();
    rows.map(|i| if during.contains(&i) { value(i) } else { 0.0 })
        .collect()
}

/// Times of the first and the last of some rows, s of the session.
fn instants_s(path: &Path<'_>, during: &Range<usize>) -> [f64; 2] {
    [during.start, during.end - 1].map(|row| path.samples.session_s[row])
}

/// The parameters of a contact with one occurrence.
fn parameters(
    [stiffness, damping]: [f64; 2],
    side: f64,
    at: f64,
    [from_s, to_s]: [f64; 2],
) -> Vec<f64> {
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
