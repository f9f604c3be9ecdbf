//! Screening fits every effect with few iterations to a few windows. It selects the effects that are worth a fit to all windows.

use super::excess::{ADEQUATE_EXCESS, level};
use super::ranking::join_all;
use super::rival::Rival;
use super::scan::{scanned, searched};
use super::screening_set::{MANY_ITERATIONS, ScreeningSet, sorted};
use super::search::{Search, window_costs};
use crate::effects::{Candidate, Landscape};
use crate::fit::Fit;
use crate::fit::part::{Part, quasi_random};
use crate::fit::problem::Problem;
use crate::stage::Stage;
use crate::term::Term;
use rayon::prelude::*;
use std::cell::LazyCell;

/// Number of starts of an effect that are fitted: those with the lowest estimated cost.
pub(super) const STARTS: usize = 2;
/// Number of starts that are fitted of each variant of an effect that acts in few windows.
const VARIANT_STARTS: usize = 3;
/// Number of starts of an effect whose fits are continued.
const STARTS_KEPT: usize = 1;
/// Number of starts whose fits are continued if the cost of the effect has many local optima.
const MANY_KEPT: usize = 3;
/// Number of starts whose fits are continued of each variant of an effect that acts in few windows.
const VARIANT_KEPT: usize = 2;
/// Largest number of effects whose fits are continued.
const PROMISING: usize = 14;
/// Largest number of effects whose fits are continued if the model has two masses. Such a fit takes ten times as long.
const PROMISING_BESIDE_MASSES: usize = 6;
/// Number of iterations of the continued fit of an effect if one of its starts is continued.
const SCREENING_ITERATIONS: usize = 4;
/// Least gain of an effect after its first fits, as a share of the best gain, for its fits to be continued. Of 257 effects that were named
/// on outside sets none had gained less.
const LEAST_PROMISE: f64 = 0.2;
/// Number of best effects whose fits are continued whatever they gain.
const FEWEST_PROMISING: usize = 3;
/// Number of further iterations of the best effect before other effects are scanned.
const LAST_ITERATIONS: usize = 10;
/// Number of samples on which effects are screened.
const SCREENING_SAMPLES: f64 = 3000.0;
/// Least number of windows on which effects are screened.
const SCREENING_WINDOWS: f64 = 12.0;
/// Least gain of a scanned effect after its first fits, as a share of the best gain of the other effects, for its fits to be continued.
const LEAST_SCANNED_GAIN: f64 = 0.5;
/// Number of samples in a block of windows.
const BLOCK_SAMPLES: usize = 1000;
/// Smallest and largest number of windows in a block.
const BLOCK_WINDOWS: [usize; 2] = [2, 8];
/// Least number of blocks on which effects are screened.
const FEWEST_BLOCKS: f64 = 3.0;

/// Returns the starts in groups of one variant. The starts of a group differ only in free parameters.
fn variants(starts: &[Term]) -> Vec<Vec<Term>> {
    let mut all: Vec<Vec<Term>> = Vec::new();
    for start in starts {
        match all.iter_mut().find(|like| like[0].is_same_variant(start)) {
            Some(like) => like.push(start.clone()),
            None => all.push(vec![start.clone()]),
        }
    }
    all
}

/// Returns every effect on top of `known`, fitted with few iterations to the `chosen` windows.
pub(super) fn screened(
    search: &Search<'_>,
    known: &Fit,
    chosen: &[bool],
    hints: &[Rival],
) -> Vec<Rival> {
    (search.progress)(Stage::Screening);
    let problem = search.problem;
    let as_fitted = ScreeningSet::new(problem, known, chosen);
    // The model parameters may have moved to compensate a missing effect. If `known` has no effect or its parameters are strained, the fits
    // begin at the stated values.
    let have_gone = known.hypothesis.terms.is_empty() || known.is_strained();
    let given = have_gone.then(|| known.as_stated());
    let as_given = given
        .as_ref()
        .map(|given| ScreeningSet::new(problem, given, chosen));
    let field = as_given.as_ref().unwrap_or(&as_fitted);
    // A scanned effect with a single start has a hint, and is not scanned.
    let is_scan = |c: &Candidate| match c.effect.landscape() {
        Landscape::Rugged => true,
        landscape => landscape.is_scanned() && c.starts.len() > 1,
    };
    let tried = search.tried(field.known, hints);
    let (scans, few): (Vec<_>, Vec<_>) = tried.into_iter().partition(is_scan);
    let (hinted, few): (Vec<_>, Vec<_>) = few
        .into_iter()
        .partition(|c| c.effect.landscape().is_scanned());
    let has_two_masses = search.has_two_masses(known);
    let fitted = fitted_on(search, known, chosen, &few, f64::INFINITY, |candidate| {
        let effect = candidate.effect;
        let (field, most_starts, kept) = if effect.is_local() {
            // An effect that acts in few windows keeps the model parameters. Hard contacts have many poor local optima.
            (&as_fitted, VARIANT_STARTS, VARIANT_KEPT)
        } else if effect.landscape() == Landscape::Hysteretic && !has_two_masses {
            // The estimated cost of such a start says little about its cost after the fit, so all starts are fitted. With two masses that
            // would take too long.
            (field, candidate.starts.len(), STARTS_KEPT)
        } else {
            (field, STARTS, STARTS_KEPT)
        };
        let fits = variants(&candidate.starts).into_par_iter();
        let fits = fits.flat_map(|v| field.short_fits(&field.promising(&v, most_starts), kept));
        sorted(fits.collect())
    });
    let mut rivals = Vec::new();
    join_all(&mut rivals, fitted);
    let whole = LazyCell::new(|| ScreeningSet::new(problem, field.known, blocks(problem)));
    if !hinted.is_empty() {
        let whole = &*whole;
        let fitted = fitted_on(
            search,
            known,
            &whole.chosen,
            &hinted,
            f64::INFINITY,
            |candidate| whole.short_fits(&candidate.starts, STARTS_KEPT),
        );
        join_all(&mut rivals, weighed(search, fitted, chosen));
    }
    // Scanned effects have more parameters, and their fits take most of the time.
    if !scans.is_empty() && !suffices(search, &mut rivals, chosen) {
        let soon = soon(search, field.known);
        let whole = &*whole;
        let fits = rivals.iter().map(|rival| &rival.fit);
        let best = fits.min_by(|a, b| level(a).total_cmp(&level(b)));
        let best = best.unwrap_or(field.known);
        let [before, after] = [field.known, best].map(|fit| whole.cost_of(fit));
        let enough = before - LEAST_SCANNED_GAIN * (before - after);
        let scanned = fitted_on(search, known, &whole.chosen, &scans, enough, |candidate| {
            let starts = if candidate.effect.landscape() == Landscape::Rugged {
                searched(whole, soon.as_ref(), &candidate.starts, best)
            } else {
                scanned(whole, soon.as_ref(), &candidate.starts)
            };
            whole.short_fits(&starts, MANY_KEPT)
        });
        join_all(&mut rivals, weighed(search, scanned, chosen));
    }
    rivals
}

/// Returns true if the best rival is adequate, if necessary after further iterations.
fn suffices(search: &Search<'_>, rivals: &mut [Rival], chosen: &[bool]) -> bool {
    let best = rivals
        .iter_mut()
        .min_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)));
    let Some(Rival { fit, .. }) = best else {
        return false;
    };
    let enough = search.adequate_level();
    if level(fit) > enough {
        let (hypothesis, x) = (&fit.hypothesis, fit.x.clone());
        let part = Part::Chosen(chosen);
        *fit = search.problem.fit(hypothesis, x, part, LAST_ITERATIONS);
    }
    level(fit) <= enough
}

/// Returns the rivals with their costs on the `chosen` windows, whatever windows they were fitted to. All windows are predicted for that,
/// because a hidden state needs a block of windows to settle.
pub(super) fn weighed(search: &Search<'_>, rivals: Vec<Rival>, chosen: &[bool]) -> Vec<Rival> {
    let weighed = rivals.into_par_iter().map(|mut rival| {
        let Fit { hypothesis, x, .. } = &rival.fit;
        let whole = search.problem.costs(hypothesis, x, Part::All);
        rival.fit.costs = whole.within(Part::Chosen(chosen));
        rival
    });
    weighed.collect()
}

/// Returns a screening set of the same data with restarts four times as often. Returns `None` if there is no such problem.
pub(super) fn soon<'a>(search: &'a Search<'_>, known: &'a Fit) -> Option<ScreeningSet<'a>> {
    let quarter = search.problem.quarter.as_deref()?;
    Some(ScreeningSet::new(quarter, known, blocks(quarter)))
}

/// Returns a rival for each effect in `tried` on top of `known`. `short_fits` returns the first fits of an effect. The fits of the effects
/// of lowest cost are continued if they cost no more than `enough`.
fn fitted_on(
    search: &Search<'_>,
    known: &Fit,
    chosen: &[bool],
    tried: &[Candidate],
    enough: f64,
    short_fits: impl Fn(&Candidate) -> Vec<Fit> + Sync,
) -> Vec<Rival> {
    let promising = if search.has_two_masses(known) {
        PROMISING_BESIDE_MASSES
    } else {
        PROMISING
    };
    let part = Part::Chosen(chosen);
    let fits = tried.par_iter().map(|c| (short_fits(c), c.effect.name()));
    let mut fits: Vec<(Vec<Fit>, &'static str)> = fits.collect();
    fits.sort_by(|a, b| level(&a.0[0]).total_cmp(&level(&b.0[0])));
    let there = search
        .problem
        .costs(&known.hypothesis, &known.x, part)
        .level();
    let best = fits.first().map_or(there, |(fits, _)| level(&fits[0]));
    let in_reach = (there - LEAST_PROMISE * (there - best)).max(best + ADEQUATE_EXCESS);
    fits.into_par_iter()
        .enumerate()
        .flat_map(|(rank, (fits, name))| {
            let first = level(&fits[0]);
            let is_promising = rank < FEWEST_PROMISING || rank < promising && first <= in_reach;
            let iterations = match fits.len() {
                _ if !is_promising || first > enough => 0,
                1 => SCREENING_ITERATIONS,
                _ => MANY_ITERATIONS,
            };
            // Here the model parameters are fitted as well.
            fits.into_par_iter().map(move |fit| {
                let fit = search.problem.fit(&fit.hypothesis, fit.x, part, iterations);
                Rival { name, fit }
            })
        })
        .collect()
}

/// Returns true for the windows on which effects are screened. Half of them are those of the highest cost, and half are spread evenly. If
/// the state of two masses must settle, they are chosen in blocks.
pub(super) fn screening_windows(search: &Search<'_>, known: &Fit) -> Vec<bool> {
    let problem = search.problem;
    let costs = window_costs(problem, known);
    let length = if search.has_two_masses(known) {
        block_length(problem)
    } else {
        1
    };
    let share = screening_share(
        problem,
        SCREENING_WINDOWS.max(FEWEST_BLOCKS * length as f64),
    );
    let missed: Vec<f64> = costs
        .chunks(length)
        .map(|block| block.iter().sum())
        .collect();
    let mut order: Vec<usize> = (0..missed.len()).collect();
    order.sort_by(|&a, &b| missed[b].total_cmp(&missed[a]));
    let worst = (0.5 * share * missed.len() as f64).ceil() as usize;
    let mut chosen: Vec<bool> = (0..missed.len())
        .map(|b| quasi_random(b) < 0.5 * share)
        .collect();
    for &block in order.iter().take(worst) {
        chosen[block] = true;
    }
    (0..costs.len()).map(|w| chosen[w / length]).collect()
}

/// Returns true for the windows of blocks with as many samples as screening uses. Half of them begin with a run, where no hidden state is
/// carried over yet. Half are spread evenly, and a hidden state settles in the first window of each block.
fn blocks(problem: &Problem<'_>) -> Vec<bool> {
    let length = block_length(problem);
    let half = 0.5 * screening_share(problem, FEWEST_BLOCKS * length as f64);
    let begins = problem.series.iter().flat_map(|series| {
        let count = series.windows.len();
        (0..count).map(move |w| (w as f64) < half * count as f64)
    });
    let begins = begins.enumerate();
    let chosen = begins.map(|(w, begins)| begins || quasi_random(w / length) < half);
    chosen.collect()
}

/// Returns the number of windows in a block.
fn block_length(problem: &Problem<'_>) -> usize {
    // The windows of the problem with more restarts are a quarter as long, so its blocks have four times as many windows.
    let quarters = if problem.quarter.is_some() { 1 } else { 4 };
    let [fewest, most] = BLOCK_WINDOWS.map(|windows| windows * quarters);
    let windows = BLOCK_SAMPLES * problem.window_count() / samples(problem).max(1);
    windows.clamp(fewest, most)
}

/// Returns the share of all windows on which effects are screened. It corresponds to at least `fewest` windows.
fn screening_share(problem: &Problem<'_>, fewest: f64) -> f64 {
    (SCREENING_SAMPLES / samples(problem) as f64).max(fewest / problem.window_count() as f64)
}

fn samples(problem: &Problem<'_>) -> usize {
    problem.series.iter().map(|s| s.time.len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::WHITE;
    use crate::made;
    use crate::select::next_effect::given_effect;
    use crate::select::search;
    use crate::term::{Coordinate, Scale};
    use recording::Recording;

    /// A dead band with a free width and a fixed jump.
    fn deadband(width: f64, jump: f64) -> Term {
        let free = Coordinate {
            parameter: 0,
            start: width,
            scale: Scale::Log,
        };
        let mut deadband = made::term("deadband", &[free]);
        deadband.values[1] = jump;
        deadband
    }

    #[test]
    fn every_run_begins_with_a_chosen_block_and_has_further_ones() {
        let recording = Recording {
            horizon: 0.1,
            ..made::recording(&[])
        };
        let problem = made::problem(&recording);
        let chosen = blocks(&problem);
        let mut rest = &chosen[..];
        let later = problem.series.iter().filter(|series| {
            let (of_run, others) = rest.split_at(series.windows.len());
            rest = others;
            let begins = of_run.iter().take_while(|chosen| **chosen).count();
            assert!(begins > 0);
            of_run[begins..].contains(&true)
        });
        assert!(later.count() > 0);
    }

    #[test]
    fn a_slowly_decaying_resonance_is_compared_after_it_settled() {
        let ringing = "compliance:stiffness=0.4,damping=0.0004";
        let recording = Recording {
            horizon: 0.1,
            ..made::recording(&[ringing])
        };
        search::on(&recording, |search, null| {
            let mut term = made::term("compliance", &[]);
            term.values[..2].copy_from_slice(&[0.4, 0.0004]);
            let fit = given_effect(search, null, &term).so_far;
            let by_themselves: Vec<bool> = (0..fit.costs.per_sample.len())
                .map(|w| w % 4 == 3)
                .collect();
            let part = Part::Chosen(&by_themselves);
            let unsettled = search.problem.costs(&fit.hypothesis, &fit.x, part).level();
            let name = term.kind.name;
            let weighed = weighed(search, vec![Rival { name, fit }], &by_themselves);
            let settled = level(&weighed[0].fit);
            assert!(
                settled < 2.0 * WHITE && settled < 0.2 * unsettled,
                "{settled} {unsettled}"
            );
        });
    }

    #[test]
    fn windows_of_two_masses_are_chosen_in_blocks() {
        let recording = Recording {
            horizon: 0.1,
            ..made::recording(&["compliance:stiffness=0.4,damping=0.0004"])
        };
        search::on(&recording, |search, null| {
            let term = made::term("compliance", &[]);
            let twisting = given_effect(search, null, &term).so_far;
            let alone = |known: &Fit| {
                let chosen = screening_windows(search, known);
                let isolated = chosen.windows(3).filter(|w| **w == [false, true, false]);
                isolated.count()
            };
            assert!(alone(null) > 0);
            assert_eq!(alone(&twisting), 0);
        });
    }

    #[test]
    fn starts_that_differ_only_in_free_parameters_are_one_variant() {
        let starts = [(0.1, 0.0), (0.1, 1.0), (0.3, 1.0), (0.5, 0.0)];
        let variants = variants(&starts.map(|(width, jump)| deadband(width, jump)));
        let widths = variants.iter().map(|v| v.iter().map(|t| t.values[0]));
        let widths: Vec<Vec<f64>> = widths.map(Iterator::collect).collect();
        assert_eq!(widths, [[0.1, 0.5], [0.1, 0.3]]);
    }
}
