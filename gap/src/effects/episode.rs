//! Effects that come and go: they act between instants of the session, once or more often.

use super::phrase::{Found, Part, Phrase};
use crate::guess::contact::stretches;
use crate::guess::start::linear;
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use std::fmt::Debug;
use std::ops::Range;

/// Scale of the instants at which a stay begins and ends, over its duration.
const TIME_SCALE: f64 = 0.1;

/// The parts of the search that differ between effects that come and go.
pub(crate) trait Episode: Debug + Sync {
    /// Place of the number that is 0 if the effect does nothing.
    fn strength(&self) -> usize;

    /// The terms with each other form of its last stay.
    fn otherwise(&self, _term: &Term) -> Vec<Term> {
        Vec::new()
    }

    /// The term with one more stay, during some windows of a series.
    fn returning(&self, term: &Term, series: &Series, windows: Range<usize>) -> Term;
}

/// A template with its numbers; `None` if one of them was not found. `{from}` and `{to}` are written as exactly as the
/// time between them asks for.
pub(super) fn phrase_between(found: &Found<'_>, template: &'static str) -> Option<Phrase> {
    let ends = found.value("to").zip(found.value("from"));
    let lasts = ends.map_or(0.0, |(to, from)| (to - from).abs());
    found.filled_by(template, |name, at| match name {
        "from" | "to" if lasts.is_normal() => Part::Instant {
            at: at.clone(),
            lasts,
        },
        _ => Part::Number(at.clone()),
    })
}

/// Coordinates of start and end of a stay, whose parameters begin at `place`; `places` are those of the two within a stay.
pub(super) fn instant_coordinates(
    places: [usize; 2],
    instants_s: [f64; 2],
    place: usize,
) -> [Coordinate; 2] {
    let scale = TIME_SCALE * (instants_s[1] - instants_s[0]);
    [0, 1].map(|end| linear(place + places[end], instants_s[end], scale))
}

/// Number of its stays.
pub(crate) fn stays(term: &Term) -> usize {
    term.kind.event_count(&term.values)
}

/// Place of the last stay among its numbers.
pub(super) fn last_stay(term: &Term) -> usize {
    term.kind.event_place(stays(term) - 1)
}

/// Places of the instants of its last stay.
fn last_instants(term: &Term) -> [usize; 2] {
    let within = term.kind.instants().unwrap_or_default();
    within.map(|place| last_stay(term) + place)
}

/// When it comes and goes in its last stay, s of the session.
pub(crate) fn instants(term: &Term) -> [f64; 2] {
    last_instants(term).map(|place| term.values[place])
}

/// Duration of all stays together, s.
pub(crate) fn there_s(term: &Term) -> f64 {
    let stays = term.kind.meanwhile(&term.values).into_iter().flatten();
    stays.map(|[from_s, to_s]| (to_s - from_s).max(0.0)).sum()
}

/// The times between the instants of the last stay of two terms, where those differ, s of the session.
pub(crate) fn moves(term: &Term, moved: &Term) -> Vec<[f64; 2]> {
    let pairs = instants(term).into_iter().zip(instants(moved));
    let between = pairs.map(|(a, b)| [a.min(b), a.max(b)]);
    between.filter(|[from_s, to_s]| from_s < to_s).collect()
}

/// A term whose last stay begins (0) or ends (1) later by `by_s`.
pub(crate) fn moved(term: &Term, which: usize, by_s: f64) -> Term {
    let place = last_instants(term)[which];
    term.begun(&[(place, term.values[place] + by_s)])
}

/// Two terms, with the first and the second half of the last stay.
pub(crate) fn halves(term: &Term) -> [Term; 2] {
    let [from_s, to_s] = instants(term);
    let half_s = 0.5 * (to_s - from_s);
    [moved(term, 1, -half_s), moved(term, 0, half_s)]
}

/// Its first stay from before the first sample until after the last, with no instants to fit.
pub(crate) fn lasting(term: &Term) -> Term {
    let within = term.kind.instants().unwrap_or_default();
    let [from, to] = within.map(|place| term.kind.event_place(0) + place);
    let mut lasting = term.begun(&[(from, f64::NEG_INFINITY), (to, f64::INFINITY)]);
    lasting.free.retain(|c| c.parameter < from);
    lasting.values.truncate(term.kind.parameters.len());
    lasting
}

/// A term with one more stay: in the run of windows with the largest sum of costs, and in the window with the largest cost. Empty if it
/// has its largest number of stays.
pub(crate) fn returns(
    episode: &dyn Episode,
    term: &Term,
    series: &[Series],
    window_costs: &[f64],
) -> Vec<Term> {
    if stays(term) >= term.kind.most_events() {
        return Vec::new();
    }
    let counts: Vec<usize> = series.iter().map(|s| s.windows.len()).collect();
    let again = stretches(&counts, window_costs).into_iter();
    let again = again.map(|(index, windows)| episode.returning(term, &series[index], windows));
    again.collect()
}
