//! Screening: every effect is fitted shortly to a few windows, to find those that are worth a fit to all.

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

/// Starts of an effect that are fitted, those that promise most; and of each variant of an effect that shows in few windows.
pub(super) const STARTS: usize = 2;
const VARIANT_STARTS: usize = 3;
/// Starts whose fit goes on.
const STARTS_KEPT: usize = 1;
/// Starts whose fit goes on of an effect whose cost has many optima, and of a variant.
const MANY_KEPT: usize = 3;
const VARIANT_KEPT: usize = 2;
/// Effects whose fit goes on; fewer beside a model of two masses, which takes ten times as long.
const PROMISING: usize = 14;
const PROMISING_BESIDE_MASSES: usize = 6;
const SCREENING_ITERATIONS: usize = 4;
/// Share of the best gain that such an effect must have by then, and effects that need not. Of 257 effects that were named on outside sets
/// none had gained less.
const LEAST_PROMISE: f64 = 0.2;
const FEWEST_PROMISING: usize = 3;
/// Further iterations of the best effect before others are scanned.
const LAST_ITERATIONS: usize = 10;
/// Samples on which effects are screened, and fewest windows.
const SCREENING_SAMPLES: f64 = 3000.0;
const SCREENING_WINDOWS: f64 = 12.0;
/// Share of the best other gain that a scanned effect must reach for its fit to go on.
const LEAST_SCANNED_GAIN: f64 = 0.5;
/// Samples of a block of windows, its fewest and most windows, and fewest blocks.
const BLOCK_SAMPLES: usize = 1000;
const BLOCK_WINDOWS: [usize; 2] = [2, 8];
const FEWEST_BLOCKS: f64 = 3.0;

/// The starts in groups of one variant: they differ only in numbers that a fit moves.
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

/// Every effect on top of `known`, fitted shortly to the chosen windows.
pub(super) fn screened(
    search: &Search<'_>,
    known: &Fit,
    chosen: &[bool],
    hints: &[Rival],
) -> Vec<Rival> {
    (search.progress)(Stage::Screening);
    let problem = search.problem;
    let as_fitted = ScreeningSet::new(problem, known, chosen);
    // Numbers of the model may have moved in place of an effect: without any other effect the search begins where they are stated.
    let have_gone = known.hypothesis.terms.is_empty() || known.is_strained();
    let given = have_gone.then(|| known.as_stated());
    let as_given = given
        .as_ref()
        .map(|given| ScreeningSet::new(problem, given, chosen));
    let field = as_given.as_ref().unwrap_or(&as_fitted);
    // An effect with one start has a hint.
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
            // An effect that shows in few windows does not move those numbers. Hard contacts have many poor optima.
            (&as_fitted, VARIANT_STARTS, VARIANT_KEPT)
        } else if effect.landscape() == Landscape::Hysteretic && !has_two_masses {
            // The promise of a start says little about where its fit ends. Beside two masses trying all takes too long.
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
    // Scanned effects have more numbers, and take most of the time.
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

/// True if the best rival is adequate after further iterations.
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

/// Rivals with their costs on the chosen windows, whatever windows they were fitted to. Blocks of windows are long enough for a hidden
/// state to settle, single windows are not.
pub(super) fn weighed(search: &Search<'_>, rivals: Vec<Rival>, chosen: &[bool]) -> Vec<Rival> {
    let weighed = rivals.into_par_iter().map(|mut rival| {
        let Fit { hypothesis, x, .. } = &rival.fit;
        let whole = search.problem.costs(hypothesis, x, Part::All);
        rival.fit.costs = whole.within(Part::Chosen(chosen));
        rival
    });
    weighed.collect()
}

/// Some of the same data, restarted four times as often.
pub(super) fn soon<'a>(search: &'a Search<'_>, known: &'a Fit) -> Option<ScreeningSet<'a>> {
    let quarter = search.problem.quarter.as_deref()?;
    Some(ScreeningSet::new(quarter, known, blocks(quarter)))
}

/// Rivals of the effects `tried` on top of `known`. `short_fits` returns the first fits of an effect. The fits of the most promising
/// effects are continued if they cost no more than `enough`.
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
            // Here the numbers of the model move as well.
            fits.into_par_iter().map(move |fit| {
                let fit = search.problem.fit(&fit.hypothesis, fit.x, part, iterations);
                Rival { name, fit }
            })
        })
        .collect()
}

/// The windows on which effects are screened: half of them those of the highest cost, half spread evenly. They are blocks of windows where
/// the state of two masses has to settle.
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

/// Blocks of windows with as many samples as screening takes. Half of them begin with a run, where no hidden state is carried over yet;
/// half are spread evenly, and a hidden state settles in the first window of each.
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

/// Windows in a block.
fn block_length(problem: &Problem<'_>) -> usize {
    // As long for windows that are a quarter as long.
    let quarters = if problem.quarter.is_some() { 1 } else { 4 };
    let [fewest, most] = BLOCK_WINDOWS.map(|windows| windows * quarters);
    let windows = BLOCK_SAMPLES * problem.window_count() / samples(problem).max(1);
    windows.clamp(fewest, most)
}

/// Share of the windows on which effects are screened, `fewest` of them at least.
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

    /// A dead band of a width that is fitted, and of a form that is not.
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
