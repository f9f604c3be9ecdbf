//! The diagnosis: the size of the gap, its location, the effects that cause it, and how far they close it.

mod attribution;
mod confounder;
mod corrected;
mod findings;
mod numbers;
mod prior_tension;
mod rejection;
mod steps;
mod unit_factor;
mod verdict;
mod warnings;

use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Closing, Diagnosis, FloorOf, NumberFinding, Region, Verdict};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::priors;
use crate::fit::objective::Objective;
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::instrument::frozen_input;
use crate::instrument::timing::{self, TimingDoubt};
use crate::measure::{Gap, exceeds, measure};
use crate::model_free::ModelFree;
use crate::plausible::Implausible;
use crate::select::{self, Given, Selection};
use crate::shrink::{on_another, shrink};
use crate::stage::Stage;
use crate::windows::run_order::canonical;
use crate::windows::series;
use crate::windows::unbroken::Unbroken;
use crate::{comparison, experiment, locate, ruler};
use attribution::{Attributed, Cause, attributed};
use confounder::Confounder;
pub use corrected::{CorrectedEffect, CorrectedModel};
use corrected::{corrected, nominal};
use findings::{confidence_limit, findings, tried};
use host_sim::device::Device;
use recording::Recording;
use rejection::Rejection;
use std::time::Instant;
use steps::{Closed, Step, closing_steps};
use unit_factor::UnitFactor;

/// Options of a diagnosis.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names of effects that are not tried.
    pub without: Vec<String>,
    /// Called at the begin of each stage.
    pub progress: fn(Stage),
}

impl Default for Options {
    fn default() -> Self {
        Self {
            without: Vec::new(),
            progress: |_| {},
        }
    }
}

/// A diagnosis with the corrected model.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The diagnosis.
    pub diagnosis: Diagnosis,
    /// The corrected model, for which `gap.after` was measured. Without effects and moved parameters it is the nominal model.
    pub model: CorrectedModel,
}

/// Share of the gap that the right effect may leave because of another formula. Smaller residuals are not analysed.
const MODELLING_SHARE: f64 = 0.01;

fn few(recording: &Recording, horizon_s: f64) -> Vec<series::Series> {
    series::some_coarse(recording, horizon_s, series::MOST_SAMPLES)
}

/// Diagnoses a recording.
pub fn diagnose(recording: &Recording, options: &Options) -> Outcome {
    let started = Instant::now();
    (options.progress)(Stage::Windows);
    let (ordered, indices) = canonical(recording);
    let Unbroken { recording, runs } = &Unbroken::of(&ordered);
    let as_stated = SearchResult::of(recording, options);
    let preferred = as_stated.preferred_timing();
    let within_a_row = preferred.is_some().then(|| timing::within_a_row(recording));
    let retimed = within_a_row.as_ref().map(|r| SearchResult::of(r, options));
    let closes_more =
        |other: &SearchResult<'_>| other.correction.gap.after < as_stated.correction.gap.after;
    let of_run = |part| indices[runs[part]];
    match retimed.filter(closes_more) {
        Some(retimed) => retimed.outcome(preferred, options, started, of_run),
        None => as_stated.outcome(None, options, started, of_run),
    }
}

/// The result of a search under one assumption about the delay between input and position.
struct SearchResult<'a> {
    problem: Problem<'a>,
    comparison: Option<Comparison>,
    selection: Selection,
    correction: Correction,
    implausible: Vec<Implausible>,
    rejection: Option<Rejection>,
    confounder: Option<Confounder>,
    verdict: Verdict,
    timing: Option<TimingDoubt>,
    /// The fit with the effects that were found, even if they were rejected.
    found: Fit,
    /// The fit with the effects of the search before all sets were compared.
    searched: Fit,
    /// Allowed model error, rms in position units.
    model_error: f64,
}

impl<'a> SearchResult<'a> {
    fn of(recording: &'a Recording, options: &Options) -> Self {
        let progress = options.progress;
        // If noise and restarts alone explain the residual, there is hardly an effect to name.
        let (before, is_gap) = exceeds(recording, &Device::nominal(&recording.model), FLOOR_DOUBT);
        let problem = problem(recording, before);
        let comparison = comparison::compare(&problem, |own| few(own, own.horizon));
        let given = given(recording, is_gap, comparison.as_ref(), options);

        let base = ruler::with_unstated(&problem, &given, progress);
        let residual = base
            .as_ref()
            .map(|fit| problem.plain_gap(&problem.series, fit));
        let problem = match residual {
            Some(residual) => problem.off_by(MODELLING_SHARE * residual.min(before)),
            None => problem,
        };
        let model_error = problem.modelling;
        let found = select::select(&problem, base, &given, progress);
        let searched = found.fit().clone();
        // The comparison of sets excludes a gain as far from 1 as a factor between units, so the sets of the search are examined before.
        let base = found.base();
        let unit_factor = found
            .best_sets()
            .find_map(|fit| UnitFactor::in_fit(&problem, fit, base));
        let (problem, mut selection, closed) = chosen(problem, found, &given, progress);
        let (closed, implausible) = without_implausible(&problem, &mut selection, closed);

        let baseline = Baseline::of(&problem);
        let mut correction = Correction::of(&problem, &selection, closed, &baseline);
        let frozen = frozen_input(recording).then_some(Rejection::FrozenInput);
        let rejection = unit_factor
            .map(Rejection::UnitMistake)
            .or(frozen)
            .or_else(|| correction.rejection(&baseline.model_free, &selection));
        let found = selection.fit().clone();
        if rejection.is_some() {
            selection.withdraw(0);
            correction = Correction::none(&problem, &baseline);
        }
        let confounder = Confounder::of(&problem, &selection);
        let verdict = verdict::verdict(&problem, &selection, &correction.gap, confounder);
        let by_numbers = (selection.rounds.is_empty() && is_gap)
            .then(|| Correction::of_numbers(&problem, &selection, &baseline))
            .filter(|of_numbers| {
                verdict == Verdict::NoGap
                    || rejection.is_none() && of_numbers.is_useful(&baseline.model_free)
            });
        correction = by_numbers.unwrap_or(correction);
        let verdict = verdict::with_numbers(verdict, &correction.numbers, &correction.gap);
        let timing = timing::doubt(&problem, selection.fit());
        Self {
            problem,
            comparison,
            selection,
            correction,
            implausible,
            rejection,
            confounder,
            verdict,
            timing,
            found,
            searched,
            model_error,
        }
    }

    /// Another input timing that predicts significantly better together with the effects that were found, if the gap is not explained. Effects
    /// that only compensate the timing may be missing among them, so the effects of the search are tried as well.
    fn preferred_timing(&self) -> Option<TimingDoubt> {
        let is_open = matches!(
            self.verdict,
            Verdict::PartlyExplained | Verdict::Unexplained
        );
        let is_mistake = matches!(
            self.rejection,
            Some(Rejection::UnitMistake(_) | Rejection::FrozenInput)
        );
        if !is_open || is_mistake {
            return None;
        }
        // At the error scale of a joint fit no timing is significantly better, so the allowed model error is used.
        let problem = self.problem.off_by(self.model_error);
        timing::preferred(&problem, &self.found)
            .or_else(|| timing::preferred(&problem, &self.searched))
    }

    /// The diagnosis. `retimed` is the preferred timing if the delay was estimated for it. `of_run` converts the index of a run in the
    /// search to the index in the recording.
    fn outcome(
        self,
        retimed: Option<TimingDoubt>,
        options: &Options,
        started: Instant,
        of_run: impl Fn(usize) -> usize,
    ) -> Outcome {
        let progress = options.progress;
        let Self {
            problem,
            comparison,
            selection,
            correction,
            implausible,
            rejection,
            confounder,
            verdict,
            timing,
            ..
        } = self;
        let comparison = comparison.as_ref();
        let confidence_limit = confidence_limit(verdict, timing.as_ref());
        let named = selection.rounds.iter().map(|round| round.rivals[0].name);
        let named: Vec<&str> = named.collect();
        let effects = findings(
            &problem,
            &selection,
            &correction.steps,
            &correction.closes,
            numbers::beyond_tolerance(&correction.numbers, &named, confidence_limit),
            comparison,
            confidence_limit,
        );
        let names: Vec<&str> = effects.iter().map(|effect| effect.name).collect();

        progress(Stage::Where);
        let regions = if verdict == Verdict::NoGap {
            Vec::new()
        } else {
            let mut regions = locate::regions(&problem, &selection.null, comparison);
            let named = |region: &mut Region| region.run = region.run.map(&of_run);
            regions.iter_mut().for_each(named);
            regions
        };
        progress(Stage::NextExperiment);
        let next_experiment = experiment::separating(&problem, &selection);
        let doubts = warnings::Doubts {
            comparison,
            rejection: rejection.as_ref(),
            timing: retimed.as_ref().or(timing.as_ref()),
            confounder,
            steps: &correction.steps,
            effects: &effects,
        };
        let warnings = warnings::all(&problem, &selection, &doubts);
        let diagnosis = Diagnosis {
            format: 1,
            verdict,
            regions,
            candidates: tried(&problem, &selection, &names, &implausible),
            gap: correction.gap,
            effects,
            numbers: correction.numbers,
            next_experiment,
            rejection: rejection.map(|rejection| rejection.to_string()),
            warnings,
            elapsed_s: started.elapsed().as_secs_f64(),
        };
        Outcome {
            diagnosis,
            model: correction.model,
        }
    }
}

/// The data that all fits share, for a gap `before` of the nominal model, in position units.
fn problem(recording: &Recording, before: f64) -> Problem<'_> {
    let of = |horizon_s, quarter| Problem {
        recording,
        series: few(recording, horizon_s),
        priors: priors(recording),
        modelling: MODELLING_SHARE * before,
        objective: Objective::Robust,
        quarter,
    };
    let quarter = of(0.25 * recording.horizon, None);
    of(recording.horizon, Some(Box::new(quarter)))
}

/// The results that are known before the search.
fn given<'a>(
    recording: &Recording,
    is_gap: bool,
    comparison: Option<&'a Comparison>,
    options: &'a Options,
) -> Given<'a> {
    let without = options.without.iter().map(String::as_str);
    let cleared = comparison.iter().flat_map(|compared| compared.excluded());
    let impossible = effects::all().filter(|effect| effect.is_impossible(recording));
    let impossible = impossible.map(|effect| effect.name());
    let excluded: Vec<&str> = without.chain(cleared).chain(impossible).collect();
    let like = comparison.and_then(Comparison::like);
    let like = like.filter(|like| !excluded.contains(&like.kind.name));
    Given {
        is_gap,
        measured: like.map(Match::term),
        certain: comparison.is_some_and(Comparison::is_certain),
        excluded,
    }
}

/// The final selection, after a comparison of all sets of effects by the same measure, with the shrink by each of its effects.
fn chosen<'a>(
    problem: Problem<'a>,
    found: Selection,
    given: &Given<'_>,
    progress: fn(Stage),
) -> (Problem<'a>, Selection, Closed) {
    if let Some((problem, mut measured)) = ruler::measured(&problem, &found, given, progress) {
        progress(Stage::Shrink);
        let closed = closing_steps(&problem, &mut measured);
        return (problem, measured, closed);
    }
    let mut found = found;
    progress(Stage::Shrink);
    let closed = closing_steps(&problem, &mut found);
    (problem, found, closed)
}

/// Withdraws the effects with a parameter value that no device has, and returns them with the reasons.
fn without_implausible(
    problem: &Problem<'_>,
    selection: &mut Selection,
    mut closed: Closed,
) -> (Closed, Vec<Implausible>) {
    let mut all = Vec::new();
    loop {
        let base = selection.base();
        let mut indices = selection.kept()..selection.rounds.len();
        let found = indices.find_map(|place| {
            let implausible = Implausible::of(problem, selection.fit(), base + place)?;
            Some((place, implausible))
        });
        let Some((place, implausible)) = found else {
            return (closed, all);
        };
        all.push(implausible);
        selection.withdraw_one(problem, place);
        closed = closing_steps(problem, selection);
    }
}

/// Predictions without a correction.
struct Baseline {
    /// Gap and floor of the nominal model.
    nominal: Gap,
    /// Sum of squared residuals of each window under the nominal model.
    squares: Vec<f64>,
    model_free: ModelFree,
}

impl Baseline {
    fn of(problem: &Problem<'_>) -> Self {
        let device = Device::nominal(&problem.recording.model);
        Self {
            nominal: measure(problem.recording, &device).0,
            squares: problem.nominal_squares(),
            model_free: ModelFree::of(&problem.series),
        }
    }

    /// The report of a gap that closes above a floor, from its shrink and the 95 % interval of the shrink.
    fn closing(
        &self,
        problem: &Problem<'_>,
        (floor, floor_of): (f64, FloorOf),
        shrink: f64,
        [low, high]: [f64; 2],
    ) -> Closing {
        let before = self.nominal.before;
        Closing {
            before,
            floor,
            floor_of,
            nominal_floor: self.nominal.floor,
            after: before - shrink * (before - floor),
            standing: problem.rms(&self.model_free.standing),
            coasting: problem.rms(&self.model_free.coasting),
            shrink,
            shrink_interval: [low.min(shrink), high.max(shrink)],
            unit: self.nominal.unit.clone(),
        }
    }
}

/// A corrected model, and how far it closes the gap.
struct Correction {
    model: CorrectedModel,
    gap: Closing,
    steps: Vec<Step>,
    /// Shrink by each effect, with its 95 % interval.
    closes: Vec<[f64; 3]>,
    numbers: Vec<NumberFinding>,
    /// Sum of squared residuals of each window on held-out data.
    after: Vec<f64>,
    /// Lower bound of the shrink on the windows of this recording, with 97.5 % probability.
    lowest: f64,
}

impl Correction {
    /// The nominal model without a correction.
    fn none(problem: &Problem<'_>, baseline: &Baseline) -> Self {
        let floor = (baseline.nominal.floor, FloorOf::NominalModel);
        Self {
            model: nominal(problem.recording),
            gap: baseline.closing(problem, floor, 0.0, [0.0; 2]),
            steps: Vec::new(),
            closes: Vec::new(),
            numbers: Vec::new(),
            after: baseline.squares.clone(),
            lowest: 0.0,
        }
    }

    /// The effects of a selection, with the fitted model parameters.
    fn of(
        problem: &Problem<'_>,
        selection: &Selection,
        closed: Closed,
        baseline: &Baseline,
    ) -> Self {
        let Closed { mut steps, after } = closed;
        if selection.rounds.is_empty() {
            return Self::none(problem, baseline);
        }
        let before = baseline.nominal.before;
        let model = corrected(problem, selection.fit());
        let (measured, _) = measure(problem.recording, &model.device());
        // A model whose floor is above the original gap closes nothing of it.
        let (floor, floor_of) = if measured.floor < before {
            (measured.floor, FloorOf::CorrectedModel)
        } else {
            (baseline.nominal.floor, FloorOf::NominalModel)
        };
        // The residual on the fitted recording is a lower bound of that on other recordings.
        if before > floor {
            Step::limit(&mut steps, (before - measured.before) / (before - floor));
        }
        let total = steps.last().map_or([0.0; 3], |step| step.total);
        let floors = problem.floor_squares(selection.fit());
        let interval = on_another(&baseline.squares, &after, &floors);
        let fit = selection.fit();
        let parts = attributed(problem, fit, total, interval, &baseline.squares, &floors);
        Self {
            gap: baseline.closing(problem, (floor, floor_of), total[0], interval),
            numbers: numbers::moved(problem, selection.fit(), &parts),
            closes: closes(selection, &steps, &parts),
            model,
            steps,
            after,
            lowest: total[1],
        }
    }

    /// The model parameters as fitted without an effect, if they significantly close a part of the gap.
    fn of_numbers(problem: &Problem<'_>, selection: &Selection, baseline: &Baseline) -> Self {
        let none = Self::none(problem, baseline);
        let fit = &selection.null;
        let floors = problem.floor_squares(fit);
        let after = problem.held_out(fit, |fit, half| problem.window_squares(fit, half));
        let total = shrink(&none.after, &after, &floors, &none.after);
        let interval = on_another(&baseline.squares, &after, &floors);
        let parts = attributed(problem, fit, total, interval, &none.after, &floors);
        let numbers = numbers::moved(problem, fit, &parts);
        if numbers.is_empty() || total[1] <= 0.0 {
            return none;
        }
        let model = corrected(problem, fit);
        let (measured, _) = measure(problem.recording, &model.device());
        let floor = (
            measured.floor.min(baseline.nominal.before),
            FloorOf::CorrectedModel,
        );
        Self {
            gap: baseline.closing(problem, floor, total[0], interval),
            model,
            numbers,
            after,
            lowest: total[1],
            ..none
        }
    }

    /// True if the model predicts better than no model does.
    fn is_useful(&self, model_free: &ModelFree) -> bool {
        Rejection::of(&self.after, model_free, self.lowest).is_none()
    }

    /// The reason to reject the correction, if any. An effect that two columns show needs no prediction.
    fn rejection(&self, model_free: &ModelFree, selection: &Selection) -> Option<Rejection> {
        let is_judged = !selection.rounds.is_empty() && !selection.given;
        // For effects in a few windows no data were held out.
        let lowest = match (self.gap.shrink > 0.0, selection.shows_in_few()) {
            (true, true) => self.gap.shrink,
            (true, false) => self.lowest,
            (false, _) => f64::NEG_INFINITY,
        };
        is_judged
            .then(|| Rejection::of(&self.after, model_free, lowest))
            .flatten()
    }
}

/// Shrink by each effect of a selection, with its 95 % interval: its share of the total, or if the first effect was given, its own step.
fn closes(selection: &Selection, steps: &[Step], parts: &[Attributed]) -> Vec<[f64; 3]> {
    let indices = 0..selection.rounds.len();
    let closes = indices.map(|place| {
        let own = Cause::Effect(selection.base() + place);
        let part = parts.iter().find(|part| part.cause == own);
        match part {
            Some(part) if !selection.given => part.shrink,
            _ => steps[place].own,
        }
    });
    closes.collect()
}
