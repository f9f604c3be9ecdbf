//! One more effect on top of what is known.

use super::evolution::evolved;
use super::hand;
use super::place::{bounces, earns_its_place, is_local};
use super::ranking::{contains, enough, ranked, special_cases};
use super::rival::{Rival, extended, turned};
use super::{Given, QUIET_EXCESS, is_quiet, level};
use crate::candidate::{one_sided, push_at_most, untouched};
use crate::fit::Fit;
use crate::hypothesis::{Hypothesis, Term};
use crate::perfect::Perfect;
use crate::problem::{Part, Problem};
use crate::stage::Stage;
use rayon::prelude::*;

/// Effects that are fitted on all windows after screening; from some on only those whose gain over the worst one falls short of
/// the best one's by this share of it at most: of 409 winners on blind and other sets all but one of some size were.
const FINALISTS: usize = 7;
const FEWEST_FINALISTS: usize = 3;
const IN_REACH: f64 = 0.5;
/// Those that show in few windows may be of a higher rank, so many at most.
const MOST_LOCAL: usize = 3;
/// Iterations for all of them, and for those that are near the best then.
const SHORT_ITERATIONS: usize = 3;
const FITTING_ITERATIONS: usize = 8;
/// Share of the best one's gain within which another is near it, and how many are in any case.
const NEAR: f64 = 0.3;
const ALWAYS_NEAR: usize = 2;
/// Share of the excess over the perfect level that two effects may leave in screening for no others to be looked for.
const LITTLE: f64 = 0.03;
/// Effects, each the first of a pair, on top of which a second one is looked for.
const LEADERS: usize = 3;
/// Share of the winner's gain that each gains alone: the first that led to the right pair gained 0.79 of it or more in 93 of
/// 94 on blind sets, and less than half in one.
const LEAST_LEAD: f64 = 0.3;
/// Sizes of a special case over that as which it was found without what stands beside it now.
const SIZES: [f64; 7] = [0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0];
/// More, for the one that is named.
const POLISHING_ITERATIONS: usize = 15;
/// Spread, in scales, of a search around the winner where slopes lead nowhere.
const NARROWLY: f64 = 0.15;

/// One effect on top of what was known, with what stood beside it.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// What was known without it.
    pub known: Fit,
    /// All finalists, the winner first, the others by what they leave.
    pub rivals: Vec<Rival>,
    /// Every effect as screening left it.
    pub screened: Vec<Rival>,
    /// Gain over its standard error.
    pub significance: f64,
    /// True if the winner is better than what was known on data that neither has seen.
    pub earned: bool,
    /// The model with the effects up to this one.
    pub so_far: Fit,
}

/// What all rounds share.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub given: &'a Given<'a>,
    /// Told of each stage.
    pub progress: fn(Stage),
    pub perfect: Perfect,
}

impl Search<'_> {
    /// Tries every effect on top of `known`. Of effects with many starts, what `hints` found is the only
    /// one.
    pub(crate) fn round(&self, known: &Fit, hints: &[Rival]) -> Option<Round> {
        let chosen = self.screening_windows(known);
        self.round_of(known, self.screened(known, &chosen, hints), None)
    }

    /// An effect that is known to be there, at a known size.
    pub(crate) fn given(&self, null: &Fit, term: &Term) -> Round {
        let (hypothesis, x) = extended(null, term);
        let fit = self
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Round {
            known: null.clone(),
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: term.kind.name,
                fit,
            }],
            screened: Vec::new(),
            significance: f64::INFINITY,
            earned: true,
        }
    }

    /// The round of what screening left on top of `known`, and of what was `found` there otherwise.
    fn round_of(&self, known: &Fit, screened: Vec<Rival>, found: Option<Rival>) -> Option<Round> {
        let mut rivals = self.finals(screened.clone(), known);
        if let Some(found) = found {
            join(&mut rivals, found);
            self.join_special_cases(&mut rivals, &screened);
        }
        self.judged(known, screened, rivals)
    }

    /// The two effects that explain most together, if each earns its place beside the other: the first
    /// is one of those that came out best alone in `first`, the second is looked for on top of each. One of them, where it
    /// explains as much without the other. None where the fit of both is not `worth` more.
    pub(crate) fn pair(&self, first: &Round, worth: impl Fn(&Fit) -> bool) -> Option<Vec<Round>> {
        let null = &first.known;
        // What bounces is looked for anew beside the best one.
        let mut hints = first.screened.clone();
        hints.retain(|rival| !bounces(rival.name));
        let chosen = self.screening_windows(null);
        let gain = |rival: &Rival| level(null) - level(&rival.fit);
        let least = LEAST_LEAD * gain(&first.rivals[0]);
        let leaders = first.rivals.iter().take(LEADERS);
        let leaders = leaders.filter(|rival| gain(rival) >= least);
        let unexplained = self
            .problem
            .costs(&null.hypothesis, &null.x, Part::Chosen(&chosen))
            .level();
        let most = self.perfect.level + LITTLE * (unexplained - self.perfect.level);
        let mut looked: Vec<(&Rival, Vec<Rival>)> = Vec::new();
        for leader in leaders {
            let screened = self.screened(&leader.fit, &chosen, &hints);
            if looked.is_empty() {
                hints.extend(screened.iter().filter(|r| bounces(r.name)).cloned());
            }
            let enough = screened.iter().any(|rival| level(&rival.fit) <= most);
            looked.push((leader, screened));
            if enough {
                break;
            }
        }
        let screened = looked.iter().flat_map(|(_, screened)| screened).cloned();
        let both =
            ranked(self.finals(screened.collect(), null), null, self.quiet())?.swap_remove(0);
        if !worth(&both.fit) {
            return None;
        }
        let turned = turned(&both, null)?;
        // Each in turn is looked for anew beside the other.
        let (second_alone, screened) = self.beside(&turned, null, &looked, &hints);
        let mut beside_second = self.round_of(&second_alone, screened, Some(turned))?;
        if !beside_second.earned {
            return self.alone(first, second_alone);
        }
        let both = self::turned(&beside_second.rivals[0], null)?;
        let (first_alone, screened) = self.beside(&both, null, &looked, &hints);
        let beside_first = self.round_of(&first_alone, screened, Some(both))?;
        if !beside_first.earned {
            return self.alone(first, first_alone);
        }
        beside_second.so_far = first_alone;
        Some(vec![beside_second, beside_first])
    }

    /// The second of two effects alone, where the first earns no place beside it: it had stood in for the second.
    pub(crate) fn without_first(&self, first: &Round, second: &Round) -> Option<Round> {
        let both = turned(&second.rivals[0], &first.known)?;
        let alone = self.without_last(&both, &first.known);
        let (_, earned) = earns_its_place(self.problem, &self.perfect, &alone, &both);
        if earned {
            return None;
        }
        self.alone(first, alone)?.pop()
    }

    /// The round of an effect that a search from beside another has led to, if it is the best one alone.
    fn alone(&self, first: &Round, fit: Fit) -> Option<Vec<Round>> {
        let name = fit.hypothesis.terms.first()?.kind.name;
        if level(&fit) >= level(&first.rivals[0].fit) {
            return None;
        }
        let mut rivals = first.rivals.clone();
        join(&mut rivals, Rival { name, fit });
        let round = self.judged(&first.known, first.screened.clone(), rivals)?;
        round.earned.then(|| vec![round])
    }

    /// The first of two effects alone on top of `null`, and what screening finds beside it, unless that was `looked` at.
    fn beside(
        &self,
        both: &Rival,
        null: &Fit,
        looked: &[(&Rival, Vec<Rival>)],
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
        let mut hypothesis = rival.fit.hypothesis.clone();
        let free = hypothesis.terms.pop().map_or(0, |term| term.free.len());
        let own = rival.fit.x[..rival.fit.x.len() - free].to_vec();
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

    /// One of two stops where the other gains next to nothing: beyond the motion any place would do.
    fn one_stop(&self, known: &Fit, both: &Fit) -> Option<Fit> {
        let (stops, others) = both.hypothesis.terms.split_last()?;
        let (before, own) = both.x.split_at(both.x.len() - stops.free.len());
        let travel = self.problem.recording.model.travel;
        let untouched = untouched(travel, self.problem.extremes());
        let single = one_sided(stops, own, untouched).into_iter();
        let fits = single.map(|(stop, own)| {
            let terms = [others, &[stop]].concat();
            let x = [before, &own].concat();
            let hypothesis = Hypothesis { terms };
            self.problem
                .fit(&hypothesis, x, Part::All, SHORT_ITERATIONS)
        });
        let enough = enough(known, both);
        let fits = fits.filter(|fit| level(fit) <= enough);
        fits.min_by(|a, b| level(a).total_cmp(&level(b)))
    }

    /// The most promising ones, fitted to all windows.
    fn finals(&self, mut screened: Vec<Rival>, known: &Fit) -> Vec<Rival> {
        (self.progress)(Stage::Finalists);
        screened.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
        let fitted = |rivals: Vec<Rival>, iterations: usize| -> Vec<Rival> {
            let fits = rivals.into_par_iter().map(|rival| Rival {
                name: rival.name,
                fit: self
                    .problem
                    .fit(&rival.fit.hypothesis, rival.fit.x, Part::All, iterations),
            });
            fits.collect()
        };
        let mut local = 0;
        let all = screened.clone();
        let short_of = |best: f64, share: f64, none: f64| best + share * (none - best).max(0.0);
        // On the windows of screening an effect that explains nothing leaves what is known to leave there.
        let [best, worst] = [screened.first(), screened.last()]
            .map(|rival| rival.map_or(0.0, |rival| level(&rival.fit)));
        let limit = short_of(best, IN_REACH, worst);
        let finalists = screened.into_iter().enumerate().filter(|(rank, rival)| {
            let is_local = is_local(rival.name);
            local += usize::from(is_local);
            let taken = *rank < FINALISTS || (is_local && local <= MOST_LOCAL);
            *rank < FEWEST_FINALISTS || (taken && level(&rival.fit) <= limit)
        });
        let mut rivals = fitted(
            finalists.map(|(_, rival)| rival).collect(),
            SHORT_ITERATIONS,
        );
        rivals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
        let Some(best) = rivals.first().map(|rival| level(&rival.fit)) else {
            return rivals;
        };
        let limit = short_of(best, NEAR, level(known));
        let near = rivals
            .iter()
            .take_while(|rival| level(&rival.fit) <= limit)
            .count();
        let far = rivals.split_off(near.max(ALWAYS_NEAR).min(rivals.len()));
        let mut rivals = fitted(rivals, FITTING_ITERATIONS);
        rivals.extend(far);
        self.join_special_cases(&mut rivals, &all);
        rivals
    }

    /// Adds the special cases of the best rival, fitted from where it stands in the size that suits best there.
    fn join_special_cases(&self, rivals: &mut Vec<Rival>, screened: &[Rival]) {
        let fit = |rival: &Rival, iterations| {
            let Fit { hypothesis, x, .. } = &rival.fit;
            self.problem
                .fit(hypothesis, x.clone(), Part::All, iterations)
        };
        let special = special_cases(rivals, screened)
            .into_par_iter()
            .map(|rival| {
                let sized = SIZES.into_par_iter().filter_map(|by| rival.sized(by));
                let sized = sized.map(|rival| (level(&fit(&rival, 0)), rival));
                let nearest = sized.min_by(|a, b| a.0.total_cmp(&b.0));
                let rival = nearest.map_or(rival, |(_, nearest)| nearest);
                Rival {
                    fit: fit(&rival, FITTING_ITERATIONS),
                    ..rival
                }
            });
        let special: Vec<Rival> = special.collect();
        for rival in special {
            join(rivals, rival);
        }
    }

    /// Level up to which nothing is missing.
    pub(super) fn quiet(&self) -> f64 {
        self.perfect.level + QUIET_EXCESS
    }

    /// True if the last effect of a fit acts at other times or places than its name says: a hand that never goes, or a stop
    /// that is hardly ever left.
    fn is_misnamed(&self, fit: &Fit) -> bool {
        let Some(last) = fit.last_term() else {
            return false;
        };
        match last.kind.name {
            "contact" => {
                level(fit) > self.quiet() && hand::is_lasting(self.problem, fit, FITTING_ITERATIONS)
            }
            "end_stop" => push_at_most(&last, self.problem.positions()),
            _ => false,
        }
    }

    /// The rivals in their order, the best one polished and judged.
    fn judged(&self, known: &Fit, screened: Vec<Rival>, rivals: Vec<Rival>) -> Option<Round> {
        (self.progress)(Stage::Judging);
        let mut rivals = ranked(rivals, known, self.quiet())?;
        // What needs a moment of its own is none where the same thing at all times leaves nothing.
        let halfway = 0.5 * (level(known) + level(&rivals[0].fit));
        let special = rivals.iter().position(|rival| {
            contains(rivals[0].name, rival.name)
                && level(&rival.fit) <= halfway
                && is_quiet(&rival.fit, &Perfect::of(self.problem, &rival.fit).bounded())
        });
        if let Some(special) = special {
            let special = rivals.remove(special);
            rivals.insert(0, special);
        }
        let Rival { name, fit: winner } = &mut rivals[0];
        if bounces(name) {
            let costs = |x: &[f64]| self.problem.costs(&winner.hypothesis, x, Part::All);
            (_, winner.x) = evolved(winner.x.clone(), NARROWLY, |x| costs(x).level());
        }
        if *name == "contact" {
            *winner = hand::found(self.problem, winner, FITTING_ITERATIONS);
        }
        if self.is_misnamed(winner) {
            rivals.remove(0);
            return self.judged(known, screened, rivals);
        }
        *winner = self.problem.polished(winner, POLISHING_ITERATIONS);
        if *name == "end_stop"
            && let Some(single) = self.one_stop(known, winner)
        {
            *winner = single;
        }
        let (significance, earned) =
            earns_its_place(self.problem, &self.perfect, known, &rivals[0]);
        Some(Round {
            known: known.clone(),
            so_far: rivals[0].fit.clone(),
            rivals,
            screened,
            significance,
            earned,
        })
    }
}

/// Adds a rival, or puts it in the place of one of the same name that leaves more.
fn join(rivals: &mut Vec<Rival>, rival: Rival) {
    match rivals.iter_mut().find(|other| other.name == rival.name) {
        Some(same) if level(&same.fit) <= level(&rival.fit) => {}
        Some(same) => *same = rival,
        None => rivals.push(rival),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::{Coordinate, Scale};
    use crate::made;
    use host_sim::effects;

    fn term(name: &str, start: f64) -> Term {
        let kind = effects::kind(name).unwrap();
        let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
        values[0] = start;
        Term {
            kind,
            values,
            free: vec![Coordinate {
                parameter: 0,
                start,
                scale: Scale::Log,
            }],
            sensor_on_load: false,
        }
    }

    /// What is left of friction and a dead band that is found beside it, where this is `hidden`.
    fn left(hidden: &[&str]) -> Option<&'static str> {
        let recording = made::recording(hidden);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let given = Given {
            is_gap: true,
            excluded: Vec::new(),
            measured: None,
            certain: false,
        };
        let search = Search {
            problem: &problem,
            given: &given,
            progress: |_| {},
            perfect: Perfect::of(&problem, &null).bounded(),
        };
        let first = search.given(&null, &term("coulomb", 0.006));
        let second = search.given(&first.so_far, &term("deadband", 1e-4));
        let alone = search.without_first(&first, &second)?;
        Some(alone.rivals[0].name)
    }

    #[test]
    fn what_stood_in_for_another_goes_once_that_is_found() {
        let deadband = "deadband:width=2e-4,jump=0";
        assert_eq!(left(&[deadband]), Some("deadband"));
        assert_eq!(left(&[deadband, "coulomb:level=0.006"]), None);
    }
}
