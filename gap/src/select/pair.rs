//! Finds two effects that together explain what neither of them explains alone.

use super::excess::{is_at_floor, level};
use super::next_effect::{given_effect, judged, round_of};
use super::pair_screening::screened_pairs;
use super::ranking::{join, ranked};
use super::rival::{Rival, turned};
use super::round::Round;
use super::screening::{screened, screening_windows, weighed};
use super::search::{FITTING_ITERATIONS, Search};
use super::shortlist::refit_shortlist;
use crate::effects::{self, Landscape};
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

/// Returns the rounds of the two effects that together have the lowest cost, if each is accepted beside the other. Otherwise it returns the
/// round of one of them if that explains as much alone. If `lead` is true, some pairs consist of one of the best effects of `first` and an
/// effect found on top of it. The other pairs have the lowest estimated cost together. Returns `None` if the fit of the best pair is not
/// `worth` more.
pub(super) fn pair(
    search: &Search<'_>,
    first: &Round,
    lead: bool,
    worth: impl Fn(&Fit) -> bool,
) -> Option<Vec<Round>> {
    let null = &first.known;
    // Effects whose cost has many optima and no useful slopes are searched again beside each leader.
    let mut hints = first.screened.clone();
    hints.retain(|rival| effects::of(rival.name).landscape() != Landscape::Rugged);
    let chosen = screening_windows(search, null);
    let leaders = leaders(search, first, if lead { LEADERS } else { 0 });
    let (looked, suffices) = led(search, null, leaders, &chosen, &hints);
    let led = looked.iter().flat_map(|(_, screened)| screened).cloned();
    let mut both: Vec<Rival> = led.collect();
    if !suffices {
        both.extend(screened_pairs(search, null, &chosen, &first.screened));
    }
    let finals = refit_shortlist(search, both, null, None);
    let both = ranked(finals, null, search.adequate_level())?.swap_remove(0);
    if !worth(&both.fit) {
        return None;
    }
    each_anew(search, first, &both, &looked, &hints)
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

/// Returns the rounds of two effects, each searched again beside the other. If one of them is not accepted, it returns the round of the
/// other effect alone. The round that was not accepted follows if its effect was searched on top of that effect.
fn each_anew(
    search: &Search<'_>,
    first: &Round,
    both: &Rival,
    looked: &[(Rival, Vec<Rival>)],
    hints: &[Rival],
) -> Option<Vec<Round>> {
    let null = &first.known;
    let turned = turned(both)?;
    let (second_alone, screened) = beside(search, &turned, null, looked, hints);
    let mut beside_second = round_of(search, &second_alone, screened, Some(turned))?;
    if !beside_second.acceptance.accepted {
        return alone_beside(search, first, second_alone, beside_second);
    }
    let both = self::turned(&beside_second.rivals[0])?;
    let (first_alone, screened) = beside(search, &both, null, looked, hints);
    let beside_first = round_of(search, &first_alone, screened, Some(both))?;
    if !beside_first.acceptance.accepted {
        return alone_beside(search, first, first_alone, beside_first);
    }
    beside_second.so_far = first_alone;
    Some(vec![beside_second, beside_first])
}

/// Returns the round of an effect alone, and the round of a second effect that was not accepted beside it.
fn alone_beside(search: &Search<'_>, first: &Round, fit: Fit, beside: Round) -> Option<Vec<Round>> {
    let names = |fit: &Fit| fit.hypothesis.terms.first().map(|term| term.kind.name);
    let alone = alone(search, first, fit)?;
    let is_same = names(&alone.so_far) == names(&beside.known);
    let beside = Some(beside).filter(|_| is_same);
    Some(core::iter::once(alone).chain(beside).collect())
}

/// Returns the round of an effect alone, fitted from its parameters in a pair. Returns `None` if its cost is not lower than that of the
/// first effect, or if it is not accepted.
fn alone(search: &Search<'_>, first: &Round, fit: Fit) -> Option<Round> {
    let name = fit.hypothesis.terms.first()?.kind.name;
    if !first.leaves_more_than(&fit) {
        return None;
    }
    let mut rivals = first.rivals.clone();
    join(&mut rivals, Rival { name, fit });
    let round = judged(search, &first.known, first.screened.clone(), rivals)?;
    round.acceptance.accepted.then_some(round)
}

/// Returns the fit of the first of two effects alone on top of `null`, and the effects that pass screening beside it. These are taken from
/// `looked` if it contains them.
fn beside(
    search: &Search<'_>,
    both: &Rival,
    null: &Fit,
    looked: &[(Rival, Vec<Rival>)],
    hints: &[Rival],
) -> (Fit, Vec<Rival>) {
    let first = both.fit.hypothesis.terms.first().map(|term| term.kind.name);
    let alone = without_last(search, both, null);
    let Some((leader, screened)) = looked.iter().find(|(l, _)| Some(l.name) == first) else {
        let chosen = screening_windows(search, &alone);
        let screened = screened(search, &alone, &chosen, hints);
        return (alone, screened);
    };
    // The fit that began beside the other effect may have the lower cost.
    let alone = if level(&leader.fit) <= level(&alone) {
        leader.fit.clone()
    } else {
        alone
    };
    (alone, screened.clone())
}

/// Returns the fit of a pair without its second effect. It is fitted twice: with the model parameters of the pair, and with those of
/// `null`. The fit of lower cost is returned.
fn without_last(search: &Search<'_>, rival: &Rival, null: &Fit) -> Fit {
    let last = rival.fit.hypothesis.terms.len().saturating_sub(1);
    let (hypothesis, own) = rival.fit.without(last);
    let given = [&null.x, &own[null.x.len()..]].concat();
    let fit = |x| {
        search
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS)
    };
    if own == given {
        return fit(own);
    }
    let (own, given) = rayon::join(|| fit(own), || fit(given));
    if level(&own) <= level(&given) {
        own
    } else {
        given
    }
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
