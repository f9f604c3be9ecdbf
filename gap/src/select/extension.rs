//! What is left beside the effects that were found.

use super::excess::is_at_floor;
use super::next_effect::{LEAST_PROMISED, LEAST_PROMISED_AT_FLOOR, next_effect};
use super::pair::{revised, without_second};
use super::rival::Rival;
use super::search::Search;
use super::selection::Selection;

/// A selection with what is found beside it, one after the other, until nothing is. Of effects with many starts, what `hints`
/// found is the only one.
pub(super) fn extended(
    search: &Search<'_>,
    mut selection: Selection,
    hints: &[Rival],
) -> Selection {
    let mut is_revised = false;
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
        // Two that were found together have each been looked at without the other.
        let is_second = round.acceptance.earned && selection.rounds.len() == 1;
        selection.add(round);
        if let [first, second] = &selection.rounds[..]
            && is_second
            && !selection.given
            && let Some(rounds) = revised(search, first, second)
        {
            selection.rounds = rounds;
        }
        if let [_, second, third] = &selection.rounds[..]
            && !is_revised
            && let Some(instead) = without_second(search, second, third)
        {
            selection.rounds.truncate(1);
            selection.rounds.push(instead);
            is_revised = true;
        }
    }
    selection
}
