//! Findings that may stand for another cause: the effects close the gap, but could equally close the gap of an effect that is not in the
//! library.

use super::findings::confidence;
use crate::effects::{self, Family, Identification, episode};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::select::{Round, Selection};
use crate::term::Term;
use crate::windows::series::Series;
use std::fmt;

/// Number of effects from which the findings are doubted.
const MANY: usize = 3;
/// Share of a run that a temporary effect must fill to be doubted.
const LARGE_SHARE_OF_RUN: f64 = 2.0 / 3.0;
/// Confidence from which a repeated temporary effect is not doubted.
const SURE_EPISODE: f64 = 0.9;

/// The reason why the findings may stand for another cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Confounder {
    /// The motion spans less than one period of a ripple, so that any torque over the position looks the same.
    Wave {
        effect: &'static str,
        travelled: f64,
    },
    /// A compliant transmission was found together with a delayed drive or sensor. A drive with its own dynamics acts equally.
    Drive {
        resonance: &'static str,
        delayed: &'static str,
    },
    /// A spring was found together with another weight. A degressive spring acts equally.
    Restoring,
    /// So many effects were found that together they may fit any cause.
    Many { effects: usize },
    /// A temporary effect with several occurrences was found with a low confidence. Any temporary torque acts equally.
    Episode { stays: usize },
    /// A temporary effect fills most of a run. Any difference of that run acts equally.
    Run { index: usize },
}

impl Confounder {
    /// The reason to doubt the findings, if any.
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

    /// The reason to doubt the effects beyond the first `certain` ones, if any.
    fn of_effects(problem: &Problem<'_>, fit: &Fit, certain: usize) -> Option<Self> {
        let fitted = fit.hypothesis.parts(&fit.x);
        let mut too_short = fitted.filter_map(|(term, x)| {
            let effect = effects::of(term.kind.name);
            let travelled = effect.too_few_periods(&term.moved(x), problem.extremes())?;
            Some(Self::Wave {
                effect: effect.name(),
                travelled,
            })
        });
        if let Some(too_short) = too_short.next() {
            return Some(too_short);
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
        let delayed = of(Family::Lateness).next()?.name();
        let resonance = found.iter().find(|effect| effect.resonates())?.name();
        Some(Self::Drive { resonance, delayed })
    }
}

/// The temporary effect of a round, if it has one.
fn episode(round: &Round) -> Option<Term> {
    let last = round.rivals[0].fit.last_term()?;
    effects::of(last.kind.name)
        .episode()
        .is_some()
        .then_some(last)
}

/// Index of the run that an occurrence of a temporary effect nearly fills.
fn most_of_run(problem: &Problem<'_>, episode: &Term) -> Option<usize> {
    let stays = episode.kind.meanwhile(&episode.values).unwrap_or_default();
    let is_filled = |run: &usize| {
        let parts = problem.series.iter().filter(|s| s.run == *run);
        let spans = parts.filter_map(Series::session_span_s);
        let whole = spans.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        whole.is_some_and(|[first_s, last_s]| {
            let in_run_s = |[from_s, to_s]: &[f64; 2]| to_s.min(last_s) - from_s.max(first_s);
            let most_s = LARGE_SHARE_OF_RUN * (last_s - first_s);
            stays.iter().any(|stay| in_run_s(stay) >= most_s)
        })
    };
    (0..problem.recording.runs.len()).find(is_filled)
}

impl fmt::Display for Confounder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wave { effect, travelled } => write!(
                f,
                "the motion spans only {travelled:.1} periods of the {effect}: any torque over the position would look the same; \
                 record a longer travel to see whether it is periodic"
            ),
            Self::Drive { resonance, delayed } => write!(
                f,
                "{resonance} and {delayed} together act like a drive with a resonance of its own: measure the torque \
                 or the position of the motor to distinguish them"
            ),
            Self::Many { effects } => write!(
                f,
                "{effects} effects together may imitate one that is not in the library: check the first of them first"
            ),
            Self::Episode { stays } => write!(
                f,
                "an effect that acts {stays} times may be any temporary torque, such as that of a drive that loses its power: \
                 record once with nothing near the device to distinguish them"
            ),
            Self::Run { index } => write!(
                f,
                "an effect during most of run {} may be any other difference of that run: \
                 record the run again to distinguish them",
                index + 1
            ),
            Self::Restoring => f.write_str(
                "a spring and another weight together act like a degressive spring: remove one of them to distinguish them",
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

    /// True if these terms may stand for another cause. The first `certain` terms are certain.
    fn is_doubted(terms: Vec<Term>, certain: usize) -> bool {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
        Confounder::of_effects(&problem, &fit, certain).is_some()
    }

    #[test]
    fn a_ripple_of_less_than_one_period_is_doubted() {
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
    fn a_compliance_with_a_delayed_drive_or_sensor_is_doubted() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["compliance", "lag"]), 0));
        assert!(is_doubted(named(&["delay", "compliance"]), 0));
        assert!(is_doubted(named(&["compliance", "sensor_lag"]), 0));
        assert!(!is_doubted(named(&["sensor_lag", "compliance"]), 1));
        assert!(!is_doubted(named(&["compliance", "viscous"]), 0));
        assert!(!is_doubted(named(&["delay"]), 0));
    }

    #[test]
    fn a_spring_with_another_weight_is_doubted() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["spring", "gravity"]), 0));
        assert!(!is_doubted(named(&["spring", "viscous"]), 0));
    }

    #[test]
    fn three_effects_are_doubted() {
        let named = |names: &[&str]| names.iter().map(|n| made::term(n, &[])).collect();
        assert!(is_doubted(named(&["viscous", "coulomb", "torque_gain"]), 0));
        assert!(!is_doubted(
            named(&["viscous", "coulomb", "torque_gain"]),
            1
        ));
    }

    #[test]
    fn the_occurrences_of_a_temporary_effect_are_counted() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let occurrences = |effect: &str| {
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
        assert_eq!(occurrences("contact:from=1,to=2"), Some(1));
        let two = occurrences("contact:from_1=1,to_1=2,from_2=4,to_2=5");
        assert_eq!(two, Some(2));
        assert_eq!(occurrences("viscous"), None);
    }

    #[test]
    fn a_temporary_effect_that_fills_most_of_a_run_is_found() {
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
