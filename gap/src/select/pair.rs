//! Two effects that explain together what neither does alone.

use super::finals::join;
use super::level;
use super::place::earns_its_place;
use super::ranking::{enough, ranked};
use super::rival::{Rival, extended, turned};
use super::round::{FITTING_ITERATIONS, Round, Search};
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

impl Search<'_> {
    /// The two effects that explain most together, if each earns its place beside the other: of those that those best alone in
    /// `first` lead to, where they do `lead`, and those that promise most together. One of them, where it explains as much
    /// without the other. None where the fit of both is not `worth` more.
    pub(crate) fn pair(
        &self,
        first: &Round,
        lead: bool,
        worth: impl Fn(&Fit) -> bool,
    ) -> Option<Vec<Round>> {
        let null = &first.known;
        // What bounces is looked for anew beside each.
        let mut hints = first.screened.clone();
        hints.retain(|rival| effects::of(rival.name).landscape() != Landscape::Rugged);
        let chosen = self.screening_windows(null);
        let leaders = self.leaders(first, if lead { LEADERS } else { 0 });
        let (looked, suffices) = self.led(null, leaders, &chosen, &hints);
        let led = looked.iter().flat_map(|(_, screened)| screened).cloned();
        let mut both: Vec<Rival> = led.collect();
        if !suffices {
            both.extend(self.proposed(null, &chosen, &first.screened));
        }
        let finals = self.finals(both, null, None);
        let both = ranked(finals, null, self.quiet())?.swap_remove(0);
        if !worth(&both.fit) {
            return None;
        }
        self.each_anew(first, &both, &looked, &hints)
    }

    /// The `most` effects that come out best alone, of those that leave the same the first, and what two columns show: it may close
    /// next to nothing beside what is larger.
    fn leaders(&self, first: &Round, most: usize) -> Vec<Rival> {
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
        let measured = self.given.measured.as_ref();
        let measured = measured.filter(|term| leaders.iter().all(|r| r.name != term.kind.name));
        leaders.extend(measured.and_then(|term| self.given(null, term).rivals.pop()));
        leaders
    }

    /// Each leader with what screening finds on top of it, until that is enough; and whether it is.
    fn led(
        &self,
        null: &Fit,
        leaders: Vec<Rival>,
        chosen: &[bool],
        hints: &[Rival],
    ) -> (Vec<(Rival, Vec<Rival>)>, bool) {
        let Fit { hypothesis, x, .. } = null;
        let nothing = self.problem.costs(hypothesis, x, Part::Chosen(chosen));
        let most = self.perfect.level + LITTLE * (nothing.level() - self.perfect.level);
        let is_enough = |fit: &Fit| level(fit) <= most && self.problem.is_at_floor(fit);
        let mut looked: Vec<(Rival, Vec<Rival>)> = Vec::new();
        for leader in leaders {
            let screened = if self.has_two_masses(&leader.fit) {
                let settled = self.screening_windows(&leader.fit);
                self.weighed(self.screened(&leader.fit, &settled, hints), chosen)
            } else {
                self.screened(&leader.fit, chosen, hints)
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
    pub(crate) fn revised(&self, first: &Round, second: &Round) -> Option<Vec<Round>> {
        if let Some(alone) = self.without_first(first, second) {
            return Some(vec![alone]);
        }
        let both = &second.rivals[0];
        let anew = |both: &Rival, looked: &[(Rival, Vec<Rival>)]| {
            let mut rounds = self.each_anew(first, both, looked, &first.screened)?;
            rounds.retain(|round| round.place.earned);
            Some(rounds)
        };
        if let Some(simpler) = self.with_special_first(first, both) {
            return anew(&simpler, &[]);
        }
        if level(&both.fit) <= self.quiet() {
            return None;
        }
        let rounds = anew(both, &[(first.rivals[0].clone(), second.screened.clone())])?;
        let leaves_less = second.leaves_more_than(&rounds.last()?.so_far);
        leaves_less.then_some(rounds)
    }

    /// Two effects with a special case of the first in its place, which does as much beside the second: what it had more stood in
    /// for that.
    fn with_special_first(&self, first: &Round, both: &Rival) -> Option<Rival> {
        let fit = |hypothesis, x| {
            self.problem
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
        let best = ranked(all, &second_alone, self.quiet())?.swap_remove(0);
        (best.name != general).then(|| turned(&best))?
    }

    /// The rounds of two effects of which each in turn is looked for anew beside the other. If one of them then earns no place, the
    /// round of the other, with that one if it was looked for on top of just this.
    fn each_anew(
        &self,
        first: &Round,
        both: &Rival,
        looked: &[(Rival, Vec<Rival>)],
        hints: &[Rival],
    ) -> Option<Vec<Round>> {
        let null = &first.known;
        let turned = turned(both)?;
        let (second_alone, screened) = self.beside(&turned, null, looked, hints);
        let mut beside_second = self.round_of(&second_alone, screened, Some(turned))?;
        if !beside_second.place.earned {
            return self.alone_beside(first, second_alone, beside_second);
        }
        let both = self::turned(&beside_second.rivals[0])?;
        let (first_alone, screened) = self.beside(&both, null, looked, hints);
        let beside_first = self.round_of(&first_alone, screened, Some(both))?;
        if !beside_first.place.earned {
            return self.alone_beside(first, first_alone, beside_first);
        }
        beside_second.so_far = first_alone;
        Some(vec![beside_second, beside_first])
    }

    /// The second of two effects alone, where the first earns no place beside it: it had stood in for the second.
    fn without_first(&self, first: &Round, second: &Round) -> Option<Round> {
        let both = turned(&second.rivals[0])?;
        let alone = self.without_last(&both, &first.known);
        // What leaves more than the first did is not what that stood in for.
        if !first.leaves_more_than(&alone) {
            return None;
        }
        if earns_its_place(self.problem, &self.perfect, &alone, &both).earned {
            return None;
        }
        self.alone(first, alone)
    }

    /// The third of three effects in the place of the second, which had stood in for it.
    pub(crate) fn without_second(&self, second: &Round, third: &Round) -> Option<Round> {
        let all = &third.so_far;
        let (hypothesis, x) = all.without(1);
        let name = hypothesis.terms.last()?.kind.name;
        let fit = self
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        if level(&fit) > enough(&second.known, all) {
            return None;
        }
        let mut rivals = second.rivals.clone();
        join(&mut rivals, Rival { name, fit });
        let round = self.judged(&second.known, second.screened.clone(), rivals)?;
        round.place.earned.then_some(round)
    }

    /// The round of an effect alone, and of what earned no place beside it.
    fn alone_beside(&self, first: &Round, fit: Fit, beside: Round) -> Option<Vec<Round>> {
        let names = |fit: &Fit| fit.hypothesis.terms.first().map(|term| term.kind.name);
        let alone = self.alone(first, fit)?;
        let is_same = names(&alone.so_far) == names(&beside.known);
        let beside = Some(beside).filter(|_| is_same);
        Some(core::iter::once(alone).chain(beside).collect())
    }

    /// The round of an effect that a search from beside another has led to, if it is the best one alone.
    fn alone(&self, first: &Round, fit: Fit) -> Option<Round> {
        let name = fit.hypothesis.terms.first()?.kind.name;
        if !first.leaves_more_than(&fit) {
            return None;
        }
        let mut rivals = first.rivals.clone();
        join(&mut rivals, Rival { name, fit });
        let round = self.judged(&first.known, first.screened.clone(), rivals)?;
        round.place.earned.then_some(round)
    }

    /// The first of two effects alone on top of `null`, and what screening finds beside it, unless that was `looked` at.
    fn beside(
        &self,
        both: &Rival,
        null: &Fit,
        looked: &[(Rival, Vec<Rival>)],
        hints: &[Rival],
    ) -> (Fit, Vec<Rival>) {
        let first = both.fit.hypothesis.terms.first().map(|term| term.kind.name);
        let alone = self.without_last(both, null);
        let Some((leader, screened)) = looked.iter().find(|(l, _)| Some(l.name) == first) else {
            let chosen = self.screening_windows(&alone);
            let screened = self.screened(&alone, &chosen, hints);
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
    fn without_last(&self, rival: &Rival, null: &Fit) -> Fit {
        let last = rival.fit.hypothesis.terms.len().saturating_sub(1);
        let (hypothesis, own) = rival.fit.without(last);
        let given = [&null.x, &own[null.x.len()..]].concat();
        let fit = |x| {
            self.problem
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::select::round;
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
        round::on(&recording, |search, null| {
            let mut rounds: Vec<Round> = Vec::new();
            for term in terms {
                let known = rounds.last().map_or(null, |round| &round.so_far);
                rounds.push(search.given(known, term));
            }
            told(search, &rounds)
        })
    }

    #[test]
    fn of_effects_that_leave_the_same_the_first_leads() {
        let recording = made::recording(&[MORE, DEAD]);
        let leaders = round::on(&recording, |search, null| {
            let [mut first, other] = [term("coulomb", 0.006), term("deadband", 1e-4)]
                .map(|term| search.given(null, &term));
            let alike = Rival {
                name: "stribeck",
                ..first.rivals[0].clone()
            };
            first.rivals.extend([alike, other.rivals[0].clone()]);
            search.leaders(&first, LEADERS)
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
                let plain = search.given(&first.known, &term("coulomb", 0.006));
                first.rivals.extend(plain.rivals);
                let both = search.with_special_first(&first, &second.rivals[0])?;
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
                let alone = search.without_first(&rounds[0], &rounds[1])?;
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
                let instead = search.without_second(&rounds[1], &rounds[2])?;
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
            let revised = search.revised(&rounds[0], &rounds[1])?;
            let terms = &revised.last()?.so_far.hypothesis.terms;
            Some(terms.iter().map(|term| term.kind.name).collect::<Vec<_>>())
        });
        assert_eq!(names, Some(vec!["spring", "coulomb"]));
    }
}
