//! Effects that bend to what has no name: they close the gap, and would close that of another cause as well.

use super::findings::confidence;
use crate::effects::{self, Family, Identification, episode};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::select::{Round, Selection};
use crate::term::Term;
use crate::windows::series::Series;
use std::fmt;

/// Effects that are many.
const MANY: usize = 3;
/// Share of a run from which on an episode that stays has hardly come and gone in it.
const MOST_OF_RUN: f64 = 2.0 / 3.0;
/// Confidence from which an episode is one that comes more than once.
const SURE_EPISODE: f64 = 0.9;

/// Why what was found may stand in for something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StandIn {
    /// Less than a wave of a ripple was travelled: any force over position looks so.
    Wave {
        effect: &'static str,
        travelled: f64,
    },
    /// A soft transmission behind a drive that is late, or before a sensor that is: so is any drive with dynamics of its own.
    Drive {
        resonance: &'static str,
        late: &'static str,
    },
    /// A spring beside another weight: together they bend, as a spring does that softens.
    Restoring,
    /// So many effects that together they bend to any cause: of seven times that three were named on nine blind and outside sets
    /// four had another cause, and three had two.
    Many { effects: usize },
    /// An episode that comes more than once and is not for sure: so does any torque that comes and goes.
    Episode { stays: usize },
    /// An episode that stays for most of a run: so does whatever is another in that run.
    Run { index: usize },
}

impl StandIn {
    /// The reason to doubt what was found, if there is one.
    pub(super) fn of(problem: &Problem<'_>, selection: &Selection) -> Option<Self> {
        let certain = selection.base() + selection.kept();
        let of_effects = Self::of_effects(problem, selection.fit(), certain);
        let of_episode = |round: &Round| {
            let episode = episode(round)?;
            if let Some(index) = most_of_run(problem, &episode) {
                return Some(Self::Run { index });
            }
            let stays = episode::occurrences(&episode);
            let is_sure = confidence(round, selection.expected.level) >= SURE_EPISODE;
            (stays > 1 && !is_sure).then_some(Self::Episode { stays })
        };
        of_effects.or_else(|| selection.rounds.iter().find_map(of_episode))
    }

    /// The reason that lies in the effects beyond the first ones that are `certain`.
    fn of_effects(problem: &Problem<'_>, fit: &Fit, certain: usize) -> Option<Self> {
        let fitted = fit.hypothesis.parts(&fit.x);
        let mut short = fitted.filter_map(|(term, x)| {
            let effect = effects::of(term.kind.name);
            let travelled = effect.too_few_periods(&term.moved(x), problem.extremes())?;
            Some(Self::Wave {
                effect: effect.name(),
                travelled,
            })
        });
        if let Some(short) = short.next() {
            return Some(short);
        }
        let found = fit.hypothesis.terms.iter().skip(certain);
        let found = found.map(|term| effects::of(term.kind.name));
        let found: Vec<&dyn Identification> = found.collect();
        if found.len() >= MANY {
            let effects = found.len();
            return Some(Self::Many { effects });
        }
        let of = |family| found.iter().filter(move |e| e.family() == Some(family));
        if of(Family::Restoring).count() > 1 {
            return Some(Self::Restoring);
        }
        let late = of(Family::Lateness).next()?.name();
        let resonance = found.iter().find(|effect| effect.resonates())?.name();
        Some(Self::Drive { resonance, late })
    }
}

/// The episode that a round is about, if it is about one.
fn episode(round: &Round) -> Option<Term> {
    let last = round.rivals[0].fit.last_term()?;
    effects::of(last.kind.name)
        .episode()
        .is_some()
        .then_some(last)
}

/// The run of which a stay of an episode is most.
fn most_of_run(problem: &Problem<'_>, episode: &Term) -> Option<usize> {
    let stays = episode.kind.meanwhile(&episode.values).unwrap_or_default();
    let fills = |run: &usize| {
        let parts = problem.series.iter().filter(|s| s.run == *run);
        let spans = parts.filter_map(Series::session_span_s);
        let whole = spans.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        whole.is_some_and(|[first_s, last_s]| {
            let in_run_s = |[from_s, to_s]: &[f64; 2]| to_s.min(last_s) - from_s.max(first_s);
            let most_s = MOST_OF_RUN * (last_s - first_s);
            stays.iter().any(|stay| in_run_s(stay) >= most_s)
        })
    };
    (0..problem.recording.runs.len()).find(fills)
}

impl fmt::Display for StandIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wave { effect, travelled } => write!(
                f,
                "only {travelled:.1} waves of the {effect} were travelled: any force over position would look so; \
                 record a longer travel to see whether it repeats"
            ),
            Self::Drive { resonance, late } => write!(
                f,
                "{resonance} and {late} together act as a drive with a resonance of its own would: measure the torque \
                 or the motor's side to tell"
            ),
            Self::Many { effects } => write!(
                f,
                "{effects} effects together may stand in for one that has no name: look at the first of them first"
            ),
            Self::Episode { stays } => write!(
                f,
                "what comes {stays} times may be any torque that comes and goes, such as a drive that loses its power: \
                 record once with nothing near it to tell"
            ),
            Self::Run { index } => write!(
                f,
                "what is there for most of run {} may be whatever else is another in that run: \
                 record it again to tell",
                index + 1
            ),
            Self::Restoring => f.write_str(
                "a spring and another weight together act as a spring that softens would: take one of them off to tell",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;
    use crate::select::{Acceptance, Rival};
    use core::f64::consts::TAU;

    /// Whether these terms, the first ones `certain`, may stand in for something else.
    fn is_doubted(terms: Vec<Term>, certain: usize) -> bool {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
        StandIn::of_effects(&problem, &fit, certain).is_some()
    }

    #[test]
    fn a_ripple_is_one_where_it_was_seen_to_repeat() {
        let recording = made::recording(&[]);
        let [low, high] = made::problem(&recording).extremes();
        let ripple = |waves: f64| {
            let mut term = made::term("cogging", &[]);
            term.values[..2].copy_from_slice(&[1e-4, waves * TAU / (high - low)]);
            vec![term]
        };
        assert!(is_doubted(ripple(0.8), 0));
        assert!(!is_doubted(ripple(1.2), 0));
    }

    #[test]
    fn a_soft_transmission_behind_a_late_drive_may_be_the_drive() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["compliance", "lag"]), 0));
        assert!(is_doubted(named(&["delay", "compliance"]), 0));
        assert!(is_doubted(named(&["compliance", "sensor_lag"]), 0));
        assert!(!is_doubted(named(&["sensor_lag", "compliance"]), 1));
        assert!(!is_doubted(named(&["compliance", "viscous"]), 0));
        assert!(!is_doubted(named(&["delay"]), 0));
    }

    #[test]
    fn a_spring_beside_another_weight_may_be_one_that_softens() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["spring", "gravity"]), 0));
        assert!(!is_doubted(named(&["spring", "viscous"]), 0));
    }

    #[test]
    fn three_effects_may_stand_in_for_one_that_has_no_name() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["viscous", "coulomb", "torque_gain"]), 0));
        assert!(!is_doubted(
            named(&["viscous", "coulomb", "torque_gain"]),
            1
        ));
    }

    #[test]
    fn an_episode_that_comes_again_may_be_what_comes_and_goes() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let taken = |effect: &str| {
            let hypothesis = Hypothesis {
                terms: vec![made::written(effect)],
            };
            let fit = problem.fit(&hypothesis, Vec::new(), Part::All, 0);
            let name = hypothesis.terms[0].kind.name;
            let episode = episode(&Round {
                known: fit.clone(),
                so_far: fit.clone(),
                rivals: vec![Rival { name, fit }],
                screened: Vec::new(),
                acceptance: Acceptance::given(true),
                measured: None,
            });
            episode.map(|episode| episode::occurrences(&episode))
        };
        assert_eq!(taken("contact:from=1,to=2"), Some(1));
        let twice = taken("contact:from_1=1,to_1=2,from_2=4,to_2=5");
        assert_eq!(twice, Some(2));
        assert_eq!(taken("viscous"), None);
    }

    #[test]
    fn an_episode_that_stays_for_most_of_a_run_may_be_whatever_is_another_there() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let run = |episode: &str| most_of_run(&problem, &made::written(episode));
        assert_eq!(run("contact:from=5.9,to=12.1"), Some(1));
        assert_eq!(run("contact:from=7,to=14"), Some(1));
        assert_eq!(run("contact:from=8.5,to=14"), None);
        assert_eq!(run("contact:from=3,to=9"), None);
        let again = "contact:from_1=5.9,to_1=12.1,from_2=6,to_2=7";
        assert_eq!(run(again), Some(1));
    }
}
