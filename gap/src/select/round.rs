//! One more effect on top of what is known.

use super::place::{earns_its_place, is_local};
use super::{Given, LEADERS, is_quiet, level};
use crate::candidate::{Candidate, Evidence, candidates};
use crate::fit::{Fit, Part, Problem, turn};
use crate::hypothesis::{Hypothesis, Term};
use crate::motion::{Motion, Scales};
use crate::perfect::Perfect;
use crate::stage::Stage;
use rayon::prelude::*;

/// Iterations from every start, and starts of an effect that go on from there.
const FIRST_ITERATIONS: usize = 2;
const STARTS_KEPT: usize = 1;
const MANY_STARTS: usize = 5;
const MANY_STARTS_KEPT: usize = 3;
/// Effects that are fitted on then.
const PROMISING: usize = 14;
const SCREENING_ITERATIONS: usize = 4;
/// Samples that suffice to tell the promising effects from the others, and fewest windows.
const SCREENING_SAMPLES: f64 = 3000.0;
const SCREENING_WINDOWS: f64 = 12.0;
/// Effects that are fitted on all windows after screening.
const FINALISTS: usize = 7;
/// Iterations for all of them, and for those that are near the best then.
const SHORT_ITERATIONS: usize = 3;
const FITTING_ITERATIONS: usize = 8;
/// Share of the best one's gain within which another is near it, and how many are in any case.
const NEAR: f64 = 0.3;
const ALWAYS_NEAR: usize = 2;
/// More, for the one that is named.
const POLISHING_ITERATIONS: usize = 15;
/// Within this share of the gain, fewer parameters win.
const PARSIMONY: f64 = 0.04;
/// Within this share of the gain, a special case wins over what contains it.
const SPECIAL_PARSIMONY: f64 = 0.08;
/// A name is not separable from the winner within this share of the winner's gain.
const TIE_SHARE: f64 = 0.04;

/// A hypothesis that was tried in addition to what was known.
#[derive(Clone, Debug)]
pub(crate) struct Rival {
    pub name: &'static str,
    pub fit: Fit,
}

impl Rival {
    fn parameters(&self) -> usize {
        self.fit.hypothesis.terms.iter().map(|t| t.free.len()).sum()
    }

    /// Its last effect as it was fitted, as a place to start from.
    fn found(&self) -> Option<Term> {
        let mut term = self.fit.hypothesis.terms.last()?.clone();
        let x = &self.fit.x[self.fit.x.len() - term.free.len()..];
        term.values = term.at(x);
        for coordinate in &mut term.free {
            coordinate.start = term.values[coordinate.parameter];
        }
        Some(term)
    }
}

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
        self.round_with(known, hints, None)
    }

    /// An effect that is known to be there, at a known size.
    pub(crate) fn given(&self, null: &Fit, term: &Term) -> Round {
        let (hypothesis, x) = extended(null, term);
        let fit = self
            .problem
            .fit(&hypothesis, x, 0, Part::All, FITTING_ITERATIONS);
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

    fn round_with(&self, known: &Fit, hints: &[Rival], found: Option<Rival>) -> Option<Round> {
        let chosen = self.screening_windows(known);
        let screened = self.screened(known, &[], &chosen, hints);
        let mut rivals = self.finals(screened.clone(), known, &chosen);
        if let Some(found) = found {
            rivals
                .retain(|rival| rival.name != found.name || level(&rival.fit) < level(&found.fit));
            if rivals.iter().all(|rival| rival.name != found.name) {
                rivals.push(found);
            }
        }
        self.judged(known, screened, rivals)
    }

    /// The two effects that explain most together, if each earns its place beside the other: the first
    /// is one of those that came out best alone in `first`, the second is looked for on top of each.
    pub(crate) fn pair(&self, first: &Round) -> Option<[Round; 2]> {
        let null = &first.known;
        let hints = &first.screened;
        let chosen = self.screening_windows(null);
        let leaders = &first.rivals[..first.rivals.len().min(LEADERS)];
        let names: Vec<&str> = leaders.iter().map(|rival| rival.name).collect();
        let screened = leaders.iter().enumerate();
        let screened = screened
            .flat_map(|(rank, leader)| self.screened(&leader.fit, &names[..rank], &chosen, hints))
            .collect();
        let both = ranked(self.finals(screened, null, &chosen), null)?.swap_remove(0);
        let turned = turned(&both, null)?;
        // Each in turn is looked for anew beside the other.
        let mut beside_second =
            self.round_with(&self.without_last(&turned, null), hints, Some(turned))?;
        let winner = &beside_second.rivals[0];
        let both = self::turned(winner, null)?;
        let first_alone = self.without_last(&both, null);
        let beside_first = self.round_with(&first_alone, hints, Some(both))?;
        beside_second.so_far = first_alone;
        (beside_second.earned && beside_first.earned).then_some([beside_second, beside_first])
    }

    /// A rival without its last effect, fitted anew on top of `null`.
    fn without_last(&self, rival: &Rival, null: &Fit) -> Fit {
        let mut hypothesis = rival.fit.hypothesis.clone();
        let free = hypothesis.terms.pop().map_or(0, |term| term.free.len());
        let mut x = null.x.clone();
        x.extend(&rival.fit.x[null.x.len()..rival.fit.x.len() - free]);
        self.problem
            .fit(&hypothesis, x, 0, Part::All, FITTING_ITERATIONS)
    }

    /// Every effect on top of `known` but those in `skipped`, fitted to the chosen windows.
    fn screened(
        &self,
        known: &Fit,
        skipped: &[&str],
        chosen: &[bool],
        hints: &[Rival],
    ) -> Vec<Rival> {
        (self.progress)(Stage::Screening);
        let problem = self.problem;
        let device = known
            .hypothesis
            .device(&problem.recording.model, &problem.nudges, &known.x);
        let motions: Vec<Motion> = problem
            .series
            .iter()
            .map(|s| Motion::of(s, &device, problem.recording.restart_half_width))
            .collect();
        let scales = Scales::of(
            &problem.series,
            &motions,
            &device,
            problem.recording.horizon,
        );
        let window_costs = window_costs(problem, known);
        let evidence = Evidence {
            series: &problem.series,
            motions: &motions,
            scales: &scales,
            device: &device,
            window_costs: &window_costs,
        };
        let out = |name: &str| {
            let terms = &known.hypothesis.terms;
            self.given.excluded.contains(&name)
                || skipped.contains(&name)
                || terms.iter().any(|t| t.kind.name == name)
        };
        let mut tried: Vec<Candidate> = candidates(&evidence)
            .into_iter()
            .filter(|c| !out(c.kind.name))
            .collect();
        for candidate in &mut tried {
            let measured = self.given.measured.as_ref();
            if let Some(term) = measured.filter(|t| t.kind.name == candidate.kind.name) {
                candidate.starts = vec![term.clone()];
                continue;
            }
            let hint = hints.iter().find(|h| h.name == candidate.kind.name);
            if candidate.starts.len() > MANY_STARTS
                && let Some(term) = hint.and_then(Rival::found)
            {
                candidate.starts = vec![term];
            }
        }
        let part = Part::Chosen(chosen);
        let mut begun: Vec<(Vec<Fit>, &'static str)> = tried
            .par_iter()
            .map(|candidate| {
                let mut fits: Vec<Fit> = candidate
                    .starts
                    .par_iter()
                    .map(|start| {
                        let (hypothesis, x) = extended(known, start);
                        problem.fit(&hypothesis, x, known.x.len(), part, FIRST_ITERATIONS)
                    })
                    .collect();
                fits.sort_by(|a, b| level(a).total_cmp(&level(b)));
                // Two masses have many poor optima, and what is fitted first is seldom the best.
                let many = candidate.starts.len() > MANY_STARTS;
                fits.truncate(if many { MANY_STARTS_KEPT } else { STARTS_KEPT });
                (fits, candidate.kind.name)
            })
            .collect();
        begun.sort_by(|a, b| level(&a.0[0]).total_cmp(&level(&b.0[0])));
        begun
            .into_par_iter()
            .enumerate()
            .filter_map(|(rank, (fits, name))| {
                let iterations = if rank < PROMISING {
                    SCREENING_ITERATIONS
                } else {
                    0
                };
                // What the model's own numbers took of the effect, they give back now.
                let fits = fits
                    .into_par_iter()
                    .map(|fit| problem.fit(&fit.hypothesis, fit.x, 0, part, iterations));
                let fit = fits.min_by(|a, b| level(a).total_cmp(&level(b)))?;
                Some(Rival { name, fit })
            })
            .collect()
    }

    /// The most promising ones, fitted to all windows.
    fn finals(&self, mut screened: Vec<Rival>, known: &Fit, chosen: &[bool]) -> Vec<Rival> {
        let screened_level = |rival: &Rival| level_on(&rival.fit, chosen);
        (self.progress)(Stage::Finalists);
        screened.sort_by(|a, b| screened_level(a).total_cmp(&screened_level(b)));
        let fitted = |rivals: Vec<Rival>, iterations: usize| -> Vec<Rival> {
            let fits = rivals.into_par_iter().map(|rival| Rival {
                name: rival.name,
                fit: self
                    .problem
                    .fit(&rival.fit.hypothesis, rival.fit.x, 0, Part::All, iterations),
            });
            fits.collect()
        };
        let mut local = 0;
        let finalists = screened.into_iter().enumerate().filter(|(rank, rival)| {
            let is_local = is_local(rival.name);
            local += usize::from(is_local);
            *rank < FINALISTS || (is_local && local <= MOST_LOCAL)
        });
        let mut rivals = fitted(
            finalists.map(|(_, rival)| rival).collect(),
            SHORT_ITERATIONS,
        );
        rivals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
        let Some(best) = rivals.first().map(|rival| level(&rival.fit)) else {
            return rivals;
        };
        let limit = best + NEAR * (level(known) - best).max(0.0);
        let near = rivals
            .iter()
            .take_while(|rival| level(&rival.fit) <= limit)
            .count();
        let far = rivals.split_off(near.max(ALWAYS_NEAR).min(rivals.len()));
        let mut rivals = fitted(rivals, FITTING_ITERATIONS);
        rivals.extend(far);
        rivals
    }

    /// The rivals in their order, the best one polished and judged.
    fn judged(&self, known: &Fit, screened: Vec<Rival>, rivals: Vec<Rival>) -> Option<Round> {
        (self.progress)(Stage::Judging);
        let mut rivals = ranked(rivals, known)?;
        // What needs a moment of its own is none where the same thing at all times leaves nothing.
        let special = rivals.iter().position(|rival| {
            contains(rivals[0].name, rival.name)
                && is_quiet(&rival.fit, &Perfect::of(self.problem, &rival.fit))
        });
        if let Some(special) = special {
            let special = rivals.remove(special);
            rivals.insert(0, special);
        }
        let winner = &mut rivals[0].fit;
        *winner = self.problem.fit(
            &winner.hypothesis,
            winner.x.clone(),
            0,
            Part::All,
            POLISHING_ITERATIONS,
        );
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

    /// The windows on which effects are screened: half of them those that miss most, half from
    /// everywhere.
    fn screening_windows(&self, known: &Fit) -> Vec<bool> {
        let problem = self.problem;
        let costs = window_costs(problem, known);
        let samples: usize = problem.series.iter().map(|s| s.time.len()).sum();
        let count = costs.len();
        let share = (SCREENING_SAMPLES / samples as f64).max(SCREENING_WINDOWS / count as f64);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
        let mut chosen: Vec<bool> = (0..count).map(|w| turn(w) < 0.5 * share).collect();
        for &w in order
            .iter()
            .take((0.5 * share * count as f64).ceil() as usize)
        {
            chosen[w] = true;
        }
        chosen
    }
}

/// Effects that show in few windows and are among the finalists whatever their rank.
const MOST_LOCAL: usize = 3;

fn window_costs(problem: &Problem<'_>, fit: &Fit) -> Vec<f64> {
    (0..problem.window_count())
        .map(|w| fit.costs.log(w))
        .collect()
}

/// Mean robust cost on the chosen windows.
fn level_on(fit: &Fit, chosen: &[bool]) -> f64 {
    let costs = chosen.iter().enumerate().filter(|(_, chosen)| **chosen);
    let (sum, count) = costs.fold((0.0, 0), |(s, n), (w, _)| (s + fit.costs.log(w), n + 1));
    sum / f64::from(count.max(1))
}

/// `known` with one more term, at the point where both stand.
fn extended(known: &Fit, term: &Term) -> (Hypothesis, Vec<f64>) {
    let mut hypothesis = known.hypothesis.clone();
    hypothesis.terms.push(term.clone());
    let mut x = known.x.clone();
    x.extend(term.free.iter().map(|_| 0.0));
    (hypothesis, x)
}

/// A rival of two effects on top of `null` in the other order.
fn turned(both: &Rival, null: &Fit) -> Option<Rival> {
    let mut fit = both.fit.clone();
    let nudges = null.x.len();
    let [first, _] = &fit.hypothesis.terms[..] else {
        return None;
    };
    let split = first.free.len();
    let name = first.kind.name;
    fit.hypothesis.terms.swap(0, 1);
    fit.x[nudges..].rotate_left(split);
    fit.std[nudges..].rotate_left(split);
    Some(Rival { name, fit })
}

/// Best first; among those that gain nearly as much as the best, fewer parameters first.
fn ranked(mut rivals: Vec<Rival>, known: &Fit) -> Option<Vec<Rival>> {
    rivals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let best = level(&rivals.first()?.fit);
    let close = best + PARSIMONY * (level(known) - best).max(0.0);
    let winner = (0..rivals.len())
        .filter(|&i| level(&rivals[i].fit) <= close)
        .min_by_key(|&i| (rivals[i].parameters(), i))?;
    // A special case needs even less to be preferred to what contains it.
    let gain = (level(known) - best).max(0.0);
    let special = (0..rivals.len()).filter(|&i| {
        level(&rivals[i].fit) <= best + SPECIAL_PARSIMONY * gain
            && is_special(rivals[i].name, rivals[winner].name)
    });
    let winner = special.min().unwrap_or(winner);
    let winner = rivals.remove(winner);
    rivals.insert(0, winner);
    Some(rivals)
}

/// True if `special` does with fewer numbers what `general` does too.
fn is_special(special: &str, general: &str) -> bool {
    contains(general, special) || (special, general) == ("torque_offset", "asymmetric_coulomb")
}

/// True if `general` is `special` for some of its parameters.
fn contains(general: &str, special: &str) -> bool {
    matches!(
        (general, special),
        (
            "asymmetric_coulomb" | "friction_drift" | "position_dependent_coulomb",
            "coulomb"
        ) | ("backlash", "compliance")
            | ("sensor_nonlinearity", "sensor_gain")
            | (
                "cogging" | "contact" | "end_stop" | "gravity" | "spring",
                "torque_offset"
            )
            | ("cogging" | "contact" | "end_stop", "gravity" | "spring")
            | ("contact", "end_stop")
    )
}

/// Names in a round that this recording cannot tell from the winner.
pub(crate) fn ties(round: &Round) -> Vec<&'static str> {
    let winner = &round.rivals[0];
    let gain = (level(&round.known) - level(&winner.fit)).max(0.0);
    let close = level(&winner.fit) + TIE_SHARE * gain;
    let rivals = round.rivals[1..].iter();
    rivals
        .filter(|rival| level(&rival.fit) <= close && !contains(rival.name, winner.name))
        .map(|rival| rival.name)
        .collect()
}
