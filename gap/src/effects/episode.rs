//! Effects that act temporarily: in one or more intervals of the session, called occurrences.

use super::phrase::{Found, Part, Phrase};
use crate::guess::contact::stretches;
use crate::guess::start::linear;
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use std::fmt::Debug;
use std::ops::Range;

/// Scale of the coordinates of begin and end of an occurrence, as a share of its duration.
const TIME_SCALE: f64 = 0.1;

/// The parts of the search that differ between temporary effects.
pub(crate) trait Episode: Debug + Sync {
    /// Index of the parameter that is 0 if the effect has no influence.
    fn strength(&self) -> usize;

    /// The terms with all other forms of the last occurrence, for example with another side.
    fn other_forms(&self, _term: &Term) -> Vec<Term> {
        Vec::new()
    }

    /// The term with one more occurrence, during some windows of a series.
    fn with_occurrence(&self, term: &Term, series: &Series, windows: Range<usize>) -> Term;
}

/// A template filled with its numbers. Returns `None` if one of them was not found. `{from}` and `{to}` are rounded according to the time
/// between them.
pub(super) fn phrase_between(found: &Found<'_>, template: &'static str) -> Option<Phrase> {
    let ends = found.value("to").zip(found.value("from"));
    let duration = ends.map_or(0.0, |(to, from)| (to - from).abs());
    found.filled_by(template, |name, at| match name {
        "from" | "to" if duration.is_normal() => Part::Instant {
            at: at.clone(),
            lasts: duration,
        },
        _ => Part::Number(at.clone()),
    })
}

/// Coordinates of begin and end of an occurrence. Its parameters start at index `first`; `offsets` are the offsets of the two instants.
pub(super) fn instant_coordinates(
    offsets: [usize; 2],
    instants_s: [f64; 2],
    first: usize,
) -> [Coordinate; 2] {
    let scale = TIME_SCALE * (instants_s[1] - instants_s[0]);
    [0, 1].map(|end| linear(first + offsets[end], instants_s[end], scale))
}

/// Number of occurrences.
pub(crate) fn occurrences(term: &Term) -> usize {
    term.kind.event_count(&term.values)
}

/// Index of the first parameter of the last occurrence.
pub(super) fn last_occurrence(term: &Term) -> usize {
    term.kind.event_place(occurrences(term) - 1)
}

/// Indices of begin and end of the last occurrence.
fn last_instants(term: &Term) -> [usize; 2] {
    let within = term.kind.instants().unwrap_or_default();
    within.map(|place| last_occurrence(term) + place)
}

/// Begin and end of the last occurrence, s of the session.
pub(crate) fn instants(term: &Term) -> [f64; 2] {
    last_instants(term).map(|place| term.values[place])
}

/// Total duration of all occurrences, s.
pub(crate) fn total_duration_s(term: &Term) -> f64 {
    let occurrences = term.kind.meanwhile(&term.values).into_iter().flatten();
    occurrences
        .map(|[from_s, to_s]| (to_s - from_s).max(0.0))
        .sum()
}

/// Intervals between the instants of the last occurrence of two terms, s of the session.
pub(crate) fn changed_intervals(term: &Term, other: &Term) -> Vec<[f64; 2]> {
    let pairs = instants(term).into_iter().zip(instants(other));
    let between = pairs.map(|(a, b)| [a.min(b), a.max(b)]);
    between.filter(|[from_s, to_s]| from_s < to_s).collect()
}

/// The term with the begin (`which` 0) or the end (1) of the last occurrence shifted by `by_s`.
pub(crate) fn with_shifted_instant(term: &Term, which: usize, by_s: f64) -> Term {
    let place = last_instants(term)[which];
    term.starting_at(&[(place, term.values[place] + by_s)])
}

/// Two terms, with the first and the second half of the last occurrence.
pub(crate) fn halves(term: &Term) -> [Term; 2] {
    let [from_s, to_s] = instants(term);
    let half_s = 0.5 * (to_s - from_s);
    [
        with_shifted_instant(term, 1, -half_s),
        with_shifted_instant(term, 0, half_s),
    ]
}

/// The term with only the first occurrence, which lasts for the whole session and has no instants to fit.
pub(crate) fn permanent(term: &Term) -> Term {
    let within = term.kind.instants().unwrap_or_default();
    let [from, to] = within.map(|place| term.kind.event_place(0) + place);
    let mut permanent = term.starting_at(&[(from, f64::NEG_INFINITY), (to, f64::INFINITY)]);
    permanent.free.retain(|c| c.parameter < from);
    permanent.values.truncate(term.kind.parameters.len());
    permanent
}

/// The terms with one more occurrence: in the range of windows with the largest sum of costs, and in the window with the largest cost.
/// Returns none if the effect has its largest number of occurrences.
pub(crate) fn with_another_occurrence(
    episode: &dyn Episode,
    term: &Term,
    series: &[Series],
    window_costs: &[f64],
) -> Vec<Term> {
    if occurrences(term) >= term.kind.most_events() {
        return Vec::new();
    }
    let counts: Vec<usize> = series.iter().map(|s| s.windows.len()).collect();
    let more = stretches(&counts, window_costs).into_iter();
    let more = more.map(|(index, windows)| episode.with_occurrence(term, &series[index], windows));
    more.collect()
}
