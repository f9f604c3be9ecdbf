//! Which effects earn their place.

use crate::candidate::{Candidate, Evidence, candidates};
use crate::fit::{Costs, Fit, Part, Problem};
use crate::hypothesis::{Hypothesis, Term};
use crate::motion::{Motion, Scales};
use rayon::prelude::*;

/// Robust cost of a window whose residual is all noise: ln(1 + 1).
pub(crate) const PERFECT: f64 = core::f64::consts::LN_2;
/// Iterations from every start, and starts of an effect that go on from there.
const FIRST_ITERATIONS: usize = 2;
const STARTS_KEPT: usize = 1;
const MANY_STARTS: usize = 5;
const MANY_STARTS_KEPT: usize = 2;
/// Robust excess per window up to which nothing is missing: the noise is known to some 15 %.
pub(crate) const QUIET_EXCESS: f64 = 0.12;
const SCREENING_ITERATIONS: usize = 4;
/// Samples that suffice to tell the promising effects from the others, and fewest windows.
const SCREENING_SAMPLES: f64 = 3000.0;
const SCREENING_WINDOWS: f64 = 12.0;
const FITTING_ITERATIONS: usize = 10;
/// More, for the one that is named.
const POLISHING_ITERATIONS: usize = 15;
const FOLD_ITERATIONS: usize = 5;
/// Effects that are fitted on all windows after screening.
const FINALISTS: usize = 7;
/// Effects that are found at most.
const MOST_EFFECTS: usize = 3;
/// A gain on windows that the fit has not seen must be this many standard errors from zero. With some
/// thirty rivals that is a chance of about 1 % for the luckiest of them.
const LEAST_SIGNIFICANCE: f64 = 3.3;
/// A gain of so large a share of the excess is hardly luck, however few the windows.
const LARGE_SHARE: f64 = 0.2;
const LARGE_SIGNIFICANCE: f64 = 2.0;
/// And must be this share of the excess over the perfect level.
const LEAST_SHARE: f64 = 0.1;
/// Least gain per window in robust cost: below, it is not seen beside the uncertainty of the noise.
const LEAST_GAIN: f64 = 0.015;
/// Within this share of the gain, fewer parameters win.
const PARSIMONY: f64 = 0.04;
/// A name is not separable from the winner within this share of the winner's gain.
const TIE_SHARE: f64 = 0.04;

/// A hypothesis that was tried in addition to what was known.
#[derive(Clone, Debug)]
pub(crate) struct Rival {
    pub name: &'static str,
    pub fit: Fit,
}

impl Rival {
    pub(crate) fn parameters(&self) -> usize {
        self.fit.hypothesis.terms.last().map_or(0, |t| t.free.len())
    }
}

/// One effect that was accepted, with what stood beside it.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// All finalists, the winner first, the others by what they leave.
    pub rivals: Vec<Rival>,
    /// Gain over its standard error.
    pub significance: f64,
}

/// The outcome: the null, and a round for each effect.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    pub null: Fit,
    pub rounds: Vec<Round>,
    /// The round that found nothing more.
    pub last: Option<Round>,
}

impl Selection {
    /// The fit with all effects.
    pub(crate) fn fit(&self) -> &Fit {
        self.rounds
            .last()
            .map_or(&self.null, |round| &round.rivals[0].fit)
    }
}

/// Finds effects one after the other, each fitted jointly with those before it.
pub(crate) fn select(problem: &Problem<'_>, excluded: &[&str]) -> Selection {
    let bare = Hypothesis { terms: Vec::new() };
    let x = vec![0.0; bare.dimensions(&problem.nudges)];
    let null = problem.fit(&bare, x, 0, Part::All, FITTING_ITERATIONS);
    let mut selection = Selection {
        null,
        rounds: Vec::new(),
        last: None,
    };
    while selection.rounds.len() < MOST_EFFECTS {
        if !selection.rounds.is_empty() && level(selection.fit()) - PERFECT < QUIET_EXCESS {
            break;
        }
        match round(problem, selection.fit(), excluded) {
            Some((round, true)) => selection.rounds.push(round),
            Some((round, false)) => {
                selection.last = Some(round);
                break;
            }
            None => break,
        }
    }
    selection
}

/// Tries every effect on top of `known`; true if the best of them earns its place.
fn round(problem: &Problem<'_>, known: &Fit, excluded: &[&str]) -> Option<(Round, bool)> {
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
    let window_costs: Vec<f64> = (0..problem.window_count())
        .map(|w| known.costs.log(w))
        .collect();
    let evidence = Evidence {
        series: &problem.series,
        motions: &motions,
        scales: &scales,
        device: &device,
        window_costs: &window_costs,
    };
    let taken = |name: &str| known.hypothesis.terms.iter().any(|t| t.kind.name == name);
    let tried: Vec<Candidate> = candidates(&evidence)
        .into_iter()
        .filter(|c| !taken(c.kind.name) && !excluded.contains(&c.kind.name))
        .collect();
    let screening = screening_part(problem);
    let mut screened: Vec<Rival> = tried
        .par_iter()
        .filter_map(|candidate| {
            // What is bound to a moment may lie outside any part.
            let part = if is_event(candidate.kind.name) {
                Part::All
            } else {
                screening
            };
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
            let fits = fits.into_par_iter().map(|fit| {
                problem.fit(
                    &fit.hypothesis,
                    fit.x,
                    problem.nudges.len(),
                    part,
                    SCREENING_ITERATIONS,
                )
            });
            let fit = fits.min_by(|a, b| level(a).total_cmp(&level(b)))?;
            Some(Rival {
                name: candidate.kind.name,
                fit,
            })
        })
        .collect();
    screened.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let finalists: Vec<Rival> = screened
        .into_par_iter()
        .enumerate()
        .filter(|(rank, rival)| *rank < FINALISTS || is_event(rival.name))
        .map(|(_, rival)| {
            let Fit { hypothesis, x, .. } = rival.fit;
            Rival {
                name: rival.name,
                fit: problem.fit(&hypothesis, x, 0, Part::All, FITTING_ITERATIONS),
            }
        })
        .collect();
    let mut rivals = ranked(finalists, known)?;
    let winner = &mut rivals[0].fit;
    *winner = problem.fit(
        &winner.hypothesis,
        winner.x.clone(),
        0,
        Part::All,
        POLISHING_ITERATIONS,
    );
    let (significance, earned) = earns_its_place(problem, known, &rivals[0]);
    let round = Round {
        rivals,
        significance,
    };
    Some((round, earned))
}

/// Whether `winner` is better than what was known on windows that neither fit has seen: its gain there
/// over the gain's standard error, and the verdict.
fn earns_its_place(problem: &Problem<'_>, known: &Fit, winner: &Rival) -> (f64, bool) {
    let windows = 0..problem.window_count();
    let unseen = [held_out(problem, known), held_out(problem, &winner.fit)];
    let gains: Vec<f64> = windows
        .clone()
        .map(|w| unseen[0].log(w) - unseen[1].log(w))
        .collect();
    let (gain, error) = mean_and_error(&gains);
    let significance = gain / error.max(f64::MIN_POSITIVE);
    let earned = if is_event(winner.name) {
        // A moment cannot be held out: what is searched over many places and instants must gain much.
        let seen = windows.map(|w| known.costs.log(w) - winner.fit.costs.log(w));
        seen.sum::<f64>() > EVENT_GAIN && gain > LEAST_GAIN
    } else {
        let excess = (unseen[0].mean_log() - PERFECT).max(0.0);
        let least = if gain > LARGE_SHARE * excess {
            LARGE_SIGNIFICANCE
        } else {
            LEAST_SIGNIFICANCE
        };
        (harmless(&gains) || significance > least)
            && gain > LEAST_GAIN.max(LEAST_SHARE * excess)
            && no_worse_at_a_quarter(problem, known, &winner.fit)
    };
    (significance, earned)
}

/// True if the windows that get worse are nothing beside those that get better: luck does both alike. It
/// finds what shows in few windows, such as a stop.
fn harmless(gains: &[f64]) -> bool {
    let better: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    let worse: f64 = gains.iter().filter(|g| **g < 0.0).sum();
    better > HARMLESS_GAIN && -worse < HARMLESS_SHARE * better
}

const HARMLESS_SHARE: f64 = 0.25;
/// Noise alone moves the robust cost of a window by some hundredths.
const HARMLESS_GAIN: f64 = 1.5;

/// Sum of robust costs that an effect bound to a moment must gain: the logarithm of the number of places,
/// instants and sizes searched, with a margin.
const EVENT_GAIN: f64 = 4.0;

/// True for effects that are bound to a moment of one recording.
pub(crate) fn is_event(name: &str) -> bool {
    matches!(name, "contact" | "lost_counts")
}

/// The share of the windows on which effects are screened.
fn screening_part(problem: &Problem<'_>) -> Part {
    let samples: usize = problem.series.iter().map(|s| s.time.len()).sum();
    let share =
        (SCREENING_SAMPLES / samples as f64).max(SCREENING_WINDOWS / problem.window_count() as f64);
    if share < 1.0 {
        Part::Share(share)
    } else {
        Part::All
    }
}

fn level(fit: &Fit) -> f64 {
    fit.costs.mean_log()
}

/// `known` with one more term, at the point where both stand.
fn extended(known: &Fit, term: &Term) -> (Hypothesis, Vec<f64>) {
    let mut hypothesis = known.hypothesis.clone();
    hypothesis.terms.push(term.clone());
    let mut x = known.x.clone();
    x.extend(term.free.iter().map(|_| 0.0));
    (hypothesis, x)
}

/// Best first; among those that gain nearly as much as the best, fewer parameters first.
fn ranked(mut rivals: Vec<Rival>, known: &Fit) -> Option<Vec<Rival>> {
    rivals.sort_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let best = level(&rivals.first()?.fit);
    let close = best + PARSIMONY * (level(known) - best).max(0.0);
    let winner = (0..rivals.len())
        .filter(|&i| level(&rivals[i].fit) <= close)
        .min_by_key(|&i| (rivals[i].parameters(), i))?;
    let winner = rivals.remove(winner);
    rivals.insert(0, winner);
    Some(rivals)
}

/// True if `general` is `special` for some of its parameters.
fn contains(general: &str, special: &str) -> bool {
    matches!(
        (general, special),
        ("asymmetric_coulomb", "coulomb")
            | ("backlash", "compliance")
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
pub(crate) fn ties(round: &Round, known: &Fit) -> Vec<&'static str> {
    let winner = &round.rivals[0];
    let gain = (level(known) - level(&winner.fit)).max(0.0);
    let close = level(&winner.fit) + TIE_SHARE * gain;
    let rivals = round.rivals[1..].iter();
    rivals
        .filter(|rival| level(&rival.fit) <= close && !contains(rival.name, winner.name))
        .map(|rival| rival.name)
        .collect()
}

/// Costs of every window under a fit to the half that it is not in.
pub(crate) fn held_out(problem: &Problem<'_>, fit: &Fit) -> Costs {
    let halves: Vec<Costs> = [true, false]
        .into_par_iter()
        .map(|half| {
            let fold = fold(problem, fit, half);
            problem.costs(&fold.hypothesis, &fold.x, Part::Half(!half))
        })
        .collect();
    let pairs = halves[0].per_sample.iter().zip(&halves[1].per_sample);
    Costs {
        per_sample: pairs
            .map(|(a, b)| if a.is_nan() { *b } else { *a })
            .collect(),
    }
}

/// The hypothesis of `fit`, fitted to one half.
pub(crate) fn fold(problem: &Problem<'_>, fit: &Fit, half: bool) -> Fit {
    problem.fit(
        &fit.hypothesis,
        fit.x.clone(),
        0,
        Part::Half(half),
        FOLD_ITERATIONS,
    )
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let n = finite.len().max(2) as f64;
    let mean = finite.iter().sum::<f64>() / n;
    let variance = finite.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// A model in which nothing moves can look good on slow motion: with restarts four times as often it
/// must not be worse.
fn no_worse_at_a_quarter(problem: &Problem<'_>, known: &Fit, fit: &Fit) -> bool {
    let gap = |fit: &Fit| problem.plain_gap(&problem.quarter, fit);
    gap(fit) <= QUARTER_MARGIN * gap(known)
}

/// What counts as no worse, given that most of such a short window is the restart's own noise.
const QUARTER_MARGIN: f64 = 1.02;
