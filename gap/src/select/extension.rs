//! Adds further effects to those that were found.

use super::excess::is_at_floor;
use super::next_effect::{LEAST_PROMISED, LEAST_PROMISED_AT_FLOOR, next_effect};
use super::rival::Rival;
use super::search::Search;
use super::selection::Selection;

/// Adds one effect after the other to a selection until none is accepted. An effect that would be scanned begins at its start in `hints`
/// only.
pub(super) fn extended(
    search: &Search<'_>,
    mut selection: Selection,
    hints: &[Rival],
) -> Selection {
    while selection.goes_on(search.problem) {
        let fit = selection.fit();
        let promised = if is_at_floor(search.problem, fit) {
            LEAST_PROMISED_AT_FLOOR
        } else {
            LEAST_PROMISED
        };
        let Some(round) = next_effect(search, fit, hints, promised) else {
            break;
        };
        selection.add(round);
    }
    selection
}
