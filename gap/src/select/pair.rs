//! Finds two effects that together explain what neither of them explains alone.

use super::excess::{is_at_floor, level};
use super::next_effect::given_effect;
use super::pair_screening::screened_pairs;
use super::rival::Rival;
use super::round::Round;
use super::screening::{screened, screening_windows, weighed};
use super::search::Search;
use super::shortlist::refit_shortlist;
use crate::fit::Fit;
use crate::fit::part::Part;

/// Largest share of the excess that may remain with a pair in screening for the search of pairs to end. The gap must be at its floor as
/// well.
const LITTLE: f64 = 0.03;
/// Largest number of leaders. A leader is an effect on top of which a second effect is searched. For 160 pairs on outside and blind sets a
/// fourth leader found no further pair.
const LEADERS: usize = 3;
/// Largest difference in cost between two effects that explain the same. It is the mean absolute difference over the windows, as a share of
/// the gain of one effect. On outside sets it was 0.06 at most for inertia and gain, and at least 0.2 for effects of different kinds.
const LEAST_DIFFERENCE: f64 = 0.1;
/// Least gain of a leader alone, as a share of the gain of the winner. On blind sets the first leader of the right pair had 0.79 or more in
/// 93 of 94 recordings. With 0.3 one more of 300 pairs was named, and slow cases took a quarter longer.
const LEAST_LEAD: f64 = 0.7;

/// Returns pairs of effects in the order of increasing cost. Some consist of one of the best effects of `first` and an effect found on top
/// of it. The others have the lowest estimated cost together.
pub(super) fn proposed(search: &Search<'_>, first: &Round) -> Vec<Rival> {
    let null = &first.known;
    let chosen = screening_windows(search, null);
    let leaders = leaders(search, first, LEADERS);
    let (looked, suffices) = led(search, null, leaders, &chosen, &first.screened);
    let led = looked.iter().flat_map(|(_, screened)| screened).cloned();
    let mut both: Vec<Rival> = led.collect();
    if !suffices {
        both.extend(screened_pairs(search, null, &chosen, &first.screened));
    }
    let mut finals = refit_shortlist(search, both, null);
    finals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    finals
}

/// Returns up to `most` effects with the largest gains alone. Of effects that explain the same it contains one. It also contains the effect
/// that a comparison of two position columns shows, because that effect may close very little beside a larger one.
fn leaders(search: &Search<'_>, first: &Round, most: usize) -> Vec<Rival> {
    let null = &first.known;
    let gain = |rival: &Rival| level(null) - level(&rival.fit);
    let least = LEAST_LEAD * gain(&first.rivals[0]);
    let mut leaders: Vec<Rival> = Vec::new();
    for rival in first.rivals.iter().filter(|r| gain(r) >= least) {
        let is_alike = |leader: &Rival| {
            let differences = rival.fit.costs.gains(&leader.fit.costs);
            let all: f64 = differences.iter().map(|d| d.abs()).sum();
            all < LEAST_DIFFERENCE * gain(leader) * differences.len() as f64
        };
        if leaders.len() < most && !leaders.iter().any(is_alike) {
            leaders.push(rival.clone());
        }
    }
    let measured = search.given.measured.as_ref();
    let measured = measured.filter(|term| leaders.iter().all(|r| r.name != term.kind.name));
    leaders.extend(measured.and_then(|term| given_effect(search, null, term).rivals.pop()));
    leaders
}

/// Returns each leader with the effects that pass screening on top of it. It ends at the first pair that explains everything, and also
/// returns whether there is one.
fn led(
    search: &Search<'_>,
    null: &Fit,
    leaders: Vec<Rival>,
    chosen: &[bool],
    hints: &[Rival],
) -> (Vec<(Rival, Vec<Rival>)>, bool) {
    let Fit { hypothesis, x, .. } = null;
    let nothing = search.problem.costs(hypothesis, x, Part::Chosen(chosen));
    let most = search.expected.level + LITTLE * (nothing.level() - search.expected.level);
    let is_enough = |fit: &Fit| level(fit) <= most && is_at_floor(search.problem, fit);
    let mut looked: Vec<(Rival, Vec<Rival>)> = Vec::new();
    for leader in leaders {
        let screened = if search.has_two_masses(&leader.fit) {
            let settled = screening_windows(search, &leader.fit);
            weighed(
                search,
                screened(search, &leader.fit, &settled, hints),
                chosen,
            )
        } else {
            screened(search, &leader.fit, chosen, hints)
        };
        let enough = screened.iter().any(|rival| is_enough(&rival.fit));
        looked.push((leader, screened));
        if enough {
            return (looked, true);
        }
    }
    (looked, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::select::next_effect::given_effect;
    use crate::select::search;
    use crate::term::{Coordinate, Scale, Term};

    /// An effect whose first parameter is free.
    fn term(name: &str, start: f64) -> Term {
        let first = Coordinate {
            parameter: 0,
            start,
            scale: Scale::Log,
        };
        made::term(name, &[first])
    }

    #[test]
    fn of_effects_with_equal_costs_only_the_first_leads() {
        let recording = made::recording(&[MORE, DEAD]);
        let leaders = search::on(&recording, |search, null| {
            let [mut first, other] = [term("coulomb", 0.006), term("deadband", 1e-4)]
                .map(|term| given_effect(search, null, &term));
            let alike = Rival {
                name: "stribeck",
                ..first.rivals[0].clone()
            };
            first.rivals.extend([alike, other.rivals[0].clone()]);
            leaders(search, &first, LEADERS)
        });
        let names: Vec<&str> = leaders.iter().map(|leader| leader.name).collect();
        assert_eq!(names, ["coulomb", "deadband"]);
    }

    const DEAD: &str = "deadband:width=2e-4,jump=0";
    const MORE: &str = "coulomb:level=0.006";
}
