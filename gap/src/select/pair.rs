//! Two effects that explain together what neither does alone.

use super::acceptance::earns_its_place;
use super::excess::{is_at_floor, level};
use super::next_effect::{given_effect, judged, round_of};
use super::pair_screening::screened_pairs;
use super::ranking::{enough, join, ranked};
use super::rival::{Rival, extended, turned};
use super::round::Round;
use super::screening::{screened, screening_windows, weighed};
use super::search::{FITTING_ITERATIONS, Search};
use super::shortlist::refit_shortlist;
use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::part::Part;

/// Share of the excess over the perfect level that two effects may leave in screening for no others to be looked for, if they
/// leave no more than the floor of the gap.
const LITTLE: f64 = 0.03;
/// Effects, each the first of a pair, on top of which a second one is looked for: of 160 pairs on outside and blind sets a fourth
/// found none more.
const LEADERS: usize = 3;
/// Difference, in the mean over the windows, of what two effects leave, over what one gains, below which they stand for the same:
/// on outside sets it was 0.06 at most of an inertia and a gain, and 0.2 or more of effects of different kinds.
const LEAST_DIFFERENCE: f64 = 0.1;
/// Share of the winner's gain that each gains alone: the first that led to the right pair gained 0.79 of it or more in 93 of
/// 94 on blind sets. With 0.3 one more of 300 pairs was named, and slow cases took a quarter longer.
const LEAST_LEAD: f64 = 0.7;

/// The two effects that explain most together, if each earns its place beside the other: of those that those best alone in
/// `first` lead to, where they do `lead`, and those that promise most together. One of them, where it explains as much
/// without the other. None where the fit of both is not `worth` more.
pub(super) fn pair(
    search: &Search<'_>,
    first: &Round,
    lead: bool,
    worth: impl Fn(&Fit) -> bool,
) -> Option<Vec<Round>> {
    let null = &first.known;
    // What bounces is looked for anew beside each.
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
    let both = ranked(finals, null, search.quiet())?.swap_remove(0);
    if !worth(&both.fit) {
        return None;
    }
    each_anew(search, first, &both, &looked, &hints)
}

/// The `most` effects that come out best alone, of those that leave the same the first, and what two columns show: it may close
/// next to nothing beside what is larger.
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

/// Each leader with what screening finds on top of it, until that is enough; and whether it is.
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

/// What becomes of an effect and of the second that was found beside it, where the first had stood in for something.
pub(super) fn revised(search: &Search<'_>, first: &Round, second: &Round) -> Option<Vec<Round>> {
    if let Some(alone) = without_first(search, first, second) {
        return Some(vec![alone]);
    }
    let both = &second.rivals[0];
    let anew = |both: &Rival, looked: &[(Rival, Vec<Rival>)]| {
        let mut rounds = each_anew(search, first, both, looked, &first.screened)?;
        rounds.retain(|round| round.acceptance.earned);
        Some(rounds)
    };
    if let Some(simpler) = with_special_first(search, first, both) {
        return anew(&simpler, &[]);
    }
    if level(&both.fit) <= search.quiet() {
        return None;
    }
    let rounds = anew(both, &[(first.rivals[0].clone(), second.screened.clone())])?;
    let leaves_less = second.leaves_more_than(&rounds.last()?.so_far);
    leaves_less.then_some(rounds)
}

/// Two effects with a special case of the first in its place, which does as much beside the second: what it had more stood in
/// for that.
fn with_special_first(search: &Search<'_>, first: &Round, both: &Rival) -> Option<Rival> {
    let fit = |hypothesis, x| {
        search
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS)
    };
    let general = both.fit.hypothesis.terms.first()?.kind.name;
    let effect = effects::of(general);
    let specials = first.rivals.iter().filter(|r| effect.contains(r.name));
    let mut specials = specials.peekable();
    specials.peek()?;
    let (hypothesis, x) = both.fit.without(0);
    let second_alone = fit(hypothesis, x);
    let instead = specials.filter_map(|special| {
        let (hypothesis, x) = extended(&second_alone, [&special.fit.last_term()?]);
        Some(Rival {
            name: special.name,
            fit: fit(hypothesis, x),
        })
    });
    let as_found = Rival {
        name: general,
        fit: both.fit.clone(),
    };
    let all = instead.chain([as_found]).collect();
    let best = ranked(all, &second_alone, search.quiet())?.swap_remove(0);
    (best.name != general).then(|| turned(&best))?
}

/// The rounds of two effects of which each in turn is looked for anew beside the other. If one of them then earns no place, the
/// round of the other, with that one if it was looked for on top of just this.
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
    if !beside_second.acceptance.earned {
        return alone_beside(search, first, second_alone, beside_second);
    }
    let both = self::turned(&beside_second.rivals[0])?;
    let (first_alone, screened) = beside(search, &both, null, looked, hints);
    let beside_first = round_of(search, &first_alone, screened, Some(both))?;
    if !beside_first.acceptance.earned {
        return alone_beside(search, first, first_alone, beside_first);
    }
    beside_second.so_far = first_alone;
    Some(vec![beside_second, beside_first])
}

/// The second of two effects alone, where the first earns no place beside it: it had stood in for the second.
fn without_first(search: &Search<'_>, first: &Round, second: &Round) -> Option<Round> {
    let both = turned(&second.rivals[0])?;
    let fit = without_last(search, &both, &first.known);
    // What leaves more than the first did is not what that stood in for.
    if !first.leaves_more_than(&fit) {
        return None;
    }
    if earns_its_place(search.problem, &search.expected, &fit, &both).earned {
        return None;
    }
    alone(search, first, fit)
}

/// The third of three effects in the place of the second, which had stood in for it.
pub(super) fn without_second(search: &Search<'_>, second: &Round, third: &Round) -> Option<Round> {
    let all = &third.so_far;
    let (hypothesis, x) = all.without(1);
    let name = hypothesis.terms.last()?.kind.name;
    let fit = search
        .problem
        .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
    if level(&fit) > enough(&second.known, all) {
        return None;
    }
    let mut rivals = second.rivals.clone();
    join(&mut rivals, Rival { name, fit });
    let round = judged(search, &second.known, second.screened.clone(), rivals)?;
    round.acceptance.earned.then_some(round)
}

/// The round of an effect alone, and of what earned no place beside it.
fn alone_beside(search: &Search<'_>, first: &Round, fit: Fit, beside: Round) -> Option<Vec<Round>> {
    let names = |fit: &Fit| fit.hypothesis.terms.first().map(|term| term.kind.name);
    let alone = alone(search, first, fit)?;
    let is_same = names(&alone.so_far) == names(&beside.known);
    let beside = Some(beside).filter(|_| is_same);
    Some(core::iter::once(alone).chain(beside).collect())
}

/// The round of an effect that a search from beside another has led to, if it is the best one alone.
fn alone(search: &Search<'_>, first: &Round, fit: Fit) -> Option<Round> {
    let name = fit.hypothesis.terms.first()?.kind.name;
    if !first.leaves_more_than(&fit) {
        return None;
    }
    let mut rivals = first.rivals.clone();
    join(&mut rivals, Rival { name, fit });
    let round = judged(search, &first.known, first.screened.clone(), rivals)?;
    round.acceptance.earned.then_some(round)
}

/// The first of two effects alone on top of `null`, and what screening finds beside it, unless that was `looked` at.
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
    // Beside the other it may have found what it had missed alone.
    let alone = if level(&leader.fit) <= level(&alone) {
        leader.fit.clone()
    } else {
        alone
    };
    (alone, screened.clone())
}

/// A rival without its last effect, fitted anew from its own numbers of the model and from those of `null`.
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

    /// What `told` says of the rounds of some effects, one after the other, where those written in `hidden` are.
    fn told<T>(
        hidden: &[&str],
        terms: &[Term],
        told: impl Fn(&Search<'_>, &[Round]) -> Option<T>,
    ) -> Option<T> {
        let recording = made::recording(hidden);
        search::on(&recording, |search, null| {
            let mut rounds: Vec<Round> = Vec::new();
            for term in terms {
                let known = rounds.last().map_or(null, |round| &round.so_far);
                rounds.push(given_effect(search, known, term));
            }
            told(search, &rounds)
        })
    }

    #[test]
    fn of_effects_that_leave_the_same_the_first_leads() {
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

    #[test]
    fn what_a_first_had_more_than_a_special_case_goes_once_the_second_is_found() {
        let free = |parameter, start, scale| Coordinate {
            parameter,
            start,
            scale,
        };
        let varying = [free(0, 0.0, Scale::Linear(0.2)), free(2, 1.4, Scale::Log)];
        let terms = [
            made::term("position_dependent_coulomb", &varying),
            term("viscous", 5e-4),
        ];
        let names = |hidden: &[&str]| {
            told(hidden, &terms, |search, rounds| {
                let [mut first, second] = [rounds[0].clone(), rounds[1].clone()];
                let plain = given_effect(search, &first.known, &term("coulomb", 0.006));
                first.rivals.extend(plain.rivals);
                let both = with_special_first(search, &first, &second.rivals[0])?;
                let names = both.fit.hypothesis.terms.iter().map(|t| t.kind.name);
                Some(names.collect::<Vec<_>>())
            })
        };
        let drag = "viscous:coefficient=6e-4";
        assert_eq!(names(&[MORE, drag]).unwrap(), ["coulomb", "viscous"]);
        let varies = "position_dependent_coulomb:slope=2,level=1.4";
        assert_eq!(names(&[varies, drag]), None);
    }

    #[test]
    fn what_stood_in_for_another_goes_once_that_is_found() {
        let left = |hidden: &[&str]| {
            let terms = [term("coulomb", 0.006), term("deadband", 1e-4)];
            told(hidden, &terms, |search, rounds| {
                let alone = without_first(search, &rounds[0], &rounds[1])?;
                Some(alone.rivals[0].name)
            })
        };
        assert_eq!(left(&[DEAD]), Some("deadband"));
        assert_eq!(left(&[DEAD, MORE]), None);
    }

    #[test]
    fn a_second_that_stood_in_for_a_third_goes_once_that_is_found() {
        let left = |hidden: &[&str]| {
            let offset = term("torque_offset", 0.001);
            let terms = [term("coulomb", 0.006), offset, term("deadband", 1e-4)];
            told(hidden, &terms, |search, rounds| {
                let instead = without_second(search, &rounds[1], &rounds[2])?;
                let names = instead.so_far.hypothesis.terms.iter();
                Some(names.map(|term| term.kind.name).collect::<Vec<_>>())
            })
        };
        assert_eq!(left(&[DEAD, MORE]), Some(vec!["coulomb", "deadband"]));
        assert_eq!(left(&[DEAD, MORE, "torque_offset:torque=0.002"]), None);
    }

    #[test]
    fn what_stands_in_for_an_effect_gives_way_to_it_beside_the_second() {
        let hidden = ["spring:stiffness=0.1,zero=0.05", MORE];
        let terms = [term("cogging", 0.002), term("coulomb", 0.006)];
        let names = told(&hidden, &terms, |search, rounds| {
            let revised = revised(search, &rounds[0], &rounds[1])?;
            let terms = &revised.last()?.so_far.hypothesis.terms;
            Some(terms.iter().map(|term| term.kind.name).collect::<Vec<_>>())
        });
        assert_eq!(names, Some(vec!["spring", "coulomb"]));
    }
}
