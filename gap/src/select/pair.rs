//! Two effects that explain together what neither does alone.

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

/// Share of the excess that a pair may leave in screening for the search to end there, if its gap is at the floor as well.
const LITTLE: f64 = 0.03;
/// Leaders: effects on top of which a second one is looked for. Of 160 pairs on outside and blind sets a fourth leader found none more.
const LEADERS: usize = 3;
/// Difference of the costs of two effects, as the mean over the windows and over the gain of one, below which they explain the same. On
/// outside sets it was 0.06 at most for inertia and gain, and 0.2 or more for effects of different kinds.
const LEAST_DIFFERENCE: f64 = 0.1;
/// Share of the winner's gain that a leader must gain alone. On blind sets the first leader of the right pair gained 0.79 or more in 93
/// of 94 recordings. With 0.3 one more of 300 pairs was named, and slow cases took a quarter longer.
const LEAST_LEAD: f64 = 0.7;

/// The rounds of the two effects that explain most together, if each is accepted beside the other; or the round of one of them that
/// explains as much alone. Pairs come from the best effects of `first` with what is found on top of them, if `lead` is true, and from
/// those that promise most together. None if the fit of the best pair is not `worth` more.
pub(super) fn pair(
    search: &Search<'_>,
    first: &Round,
    lead: bool,
    worth: impl Fn(&Fit) -> bool,
) -> Option<Vec<Round>> {
    let null = &first.known;
    // Effects with a rugged cost are searched anew beside each leader.
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

/// The `most` effects that gain most alone, one of those that explain the same; and the effect that two columns show, which may close
/// next to nothing beside a larger one.
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

/// Each leader with the effects that pass screening on top of it, until a pair explains everything; and whether one does.
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

/// The rounds of two effects, each searched anew beside the other. If one of them is not accepted, the round of the other alone, followed
/// by the round that was not accepted if that was searched on top of this one.
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

/// The round of an effect alone, and the round beside it that was not accepted.
fn alone_beside(search: &Search<'_>, first: &Round, fit: Fit, beside: Round) -> Option<Vec<Round>> {
    let names = |fit: &Fit| fit.hypothesis.terms.first().map(|term| term.kind.name);
    let alone = alone(search, first, fit)?;
    let is_same = names(&alone.so_far) == names(&beside.known);
    let beside = Some(beside).filter(|_| is_same);
    Some(core::iter::once(alone).chain(beside).collect())
}

/// The round of an effect alone that was fitted from where it stood in a pair, if it explains more than the first effect did.
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

/// The first of two effects alone on top of `null`, and the effects that pass screening beside it, taken from `looked` if they are known.
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
    // The fit that began beside the other effect may be the better one.
    let alone = if level(&leader.fit) <= level(&alone) {
        leader.fit.clone()
    } else {
        alone
    };
    (alone, screened.clone())
}

/// A pair without its second effect, fitted anew twice: with the numbers of the model from the pair, and from `null`. The better fit.
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

    /// An effect of which the first number is free.
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
