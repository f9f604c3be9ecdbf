//! What is left beside the effects that were found.

use super::rival::Rival;
use super::round::Search;
use super::{LEAST_PROMISED, LEAST_PROMISED_AT_FLOOR, Selection};

impl Search<'_> {
    /// A selection with what is found beside it, one after the other, until nothing is. Of effects with many starts, what `hints`
    /// found is the only one.
    pub(super) fn extended(&self, mut selection: Selection, hints: &[Rival]) -> Selection {
        let mut is_revised = false;
        while selection.goes_on(self.problem) {
            let fit = selection.fit();
            let promised = if self.problem.is_at_floor(fit) {
                LEAST_PROMISED_AT_FLOOR
            } else {
                LEAST_PROMISED
            };
            let Some(round) = self.round(fit, hints, promised) else {
                break;
            };
            // Two that were found together have each been looked at without the other.
            let is_second = round.place.earned && selection.rounds.len() == 1;
            selection.add(round);
            if let [first, second] = &selection.rounds[..]
                && is_second
                && !selection.given
                && let Some(rounds) = self.revised(first, second)
            {
                selection.rounds = rounds;
            }
            if let [_, second, third] = &selection.rounds[..]
                && !is_revised
                && let Some(instead) = self.without_second(second, third)
            {
                selection.rounds.truncate(1);
                selection.rounds.push(instead);
                is_revised = true;
            }
        }
        selection
    }
}
