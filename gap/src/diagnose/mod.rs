//! The diagnosis: how large the gap is, where it lies, which effects cause it, how far it shrinks.

mod attribution;
mod corrected;
mod findings;
mod numbers;
mod rejection;
mod relief;
mod stand_in;
mod steps;
mod unit_factor;
mod verdict;
mod warnings;

use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Closing, Diagnosis, FloorOf, NumberFinding, Region, Verdict};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::priors;
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
pub use corrected::{CorrectedEffect, CorrectedModel};
use corrected::{corrected, nominal};
use findings::{findings, most_sure, tried};
use host_sim::device::Device;
use recording::Recording;
use rejection::Rejection;
use stand_in::StandIn;
use std::time::Instant;
use steps::{Closed, Step, closing_steps};
use unit_factor::UnitFactor;
use verdict::verdict;

/// What to leave out, and whom to tell.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names of effects that are not tried.
    pub without: Vec<String>,
    /// Called as each stage begins.
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

/// A diagnosis with the model that it arrived at.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What is said.
    pub diagnosis: Diagnosis,
    /// The corrected model, on which `gap.after` was measured; without effects and moved numbers it is the nominal one.
    pub model: CorrectedModel,
}

/// Share of the gap that a right effect in another formulation may leave: less is not worth a name.
const MODELLING_SHARE: f64 = 0.01;

fn few(recording: &Recording, horizon_s: f64) -> Vec<series::Series> {
    series::some_coarse(recording, horizon_s, series::MOST_SAMPLES)
}

/// Diagnoses a recording.
pub fn diagnose(recording: &Recording, options: &Options) -> Outcome {
    let started = Instant::now();
    (options.progress)(Stage::Windows);
    let (ordered, places) = canonical(recording);
    let Unbroken { recording, runs } = &Unbroken::of(&ordered);
    let as_stated = Attempt::of(recording, options);
    let preferred = as_stated.preferred_timing();
    let within_a_row = preferred.is_some().then(|| timing::within_a_row(recording));
    let retimed = within_a_row.as_ref().map(|r| Attempt::of(r, options));
    let closes_more =
        |other: &Attempt<'_>| other.correction.gap.after < as_stated.correction.gap.after;
    let of_run = |part| places[runs[part]];
    match retimed.filter(closes_more) {
        Some(retimed) => retimed.outcome(preferred, options, started, of_run),
        None => as_stated.outcome(None, options, started, of_run),
    }
}

/// A search under one assumption about the time between input and position, and what it found.
struct Attempt<'a> {
    problem: Problem<'a>,
    comparison: Option<Comparison>,
    selection: Selection,
    correction: Correction,
    implausible: Vec<Implausible>,
    rejection: Option<Rejection>,
    stand_in: Option<StandIn>,
    verdict: Verdict,
    timing: Option<TimingDoubt>,
    /// The effects that were found, even if they were rejected.
    found: Fit,
    /// Error of a right model in another formulation, in units of position.
    formulation: f64,
}

impl<'a> Attempt<'a> {
    fn of(recording: &'a Recording, options: &Options) -> Self {
        let progress = options.progress;
        // Where noise and restarts alone leave as much, there is hardly anything to name.
        let (before, is_gap) = exceeds(recording, &Device::nominal(&recording.model), FLOOR_DOUBT);
        let problem = problem(recording, before);
        let comparison = comparison::compare(&problem, |own| few(own, own.horizon));
        let given = given(recording, is_gap, comparison.as_ref(), options);

        let base = ruler::with_unstated(&problem, &given, progress);
        let left = base
            .as_ref()
            .map(|fit| problem.plain_gap(&problem.series, fit));
        let problem = match left {
            Some(left) => problem.off_by(MODELLING_SHARE * left.min(before)),
            None => problem,
        };
        let formulation = problem.modelling;
        let found = select::select(&problem, base, &given, progress);
        let (problem, mut selection, closed) = chosen(problem, found, &given, progress);
        let unit_factor = UnitFactor::in_fit(&problem, selection.fit(), selection.base());
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
        let stand_in = StandIn::of(&problem, &selection);
        let verdict = verdict(&problem, &selection, &correction.gap, stand_in);
        if verdict == Verdict::NoGap && is_gap {
            correction = Correction::of_numbers(&problem, &selection, &baseline);
        }
        let timing = timing::doubt(&problem, selection.fit());
        Self {
            problem,
            comparison,
            selection,
            correction,
            implausible,
            rejection,
            stand_in,
            verdict,
            timing,
            found,
            formulation,
        }
    }

    /// Another timing of the input that surely predicts better beside what was found, if the gap is not explained.
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
        // At an error scale of its own a search is content with any timing.
        let problem = self.problem.off_by(self.formulation);
        timing::preferred(&problem, &self.found)
    }

    /// The diagnosis. `retimed` is the timing for which the input's time was estimated. `of_run` gives the place of a run in the
    /// recording as it was given.
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
            stand_in,
            verdict,
            timing,
            ..
        } = self;
        let comparison = comparison.as_ref();
        let most_sure = most_sure(verdict, timing.as_ref());
        let named = selection.rounds.iter().map(|round| round.rivals[0].name);
        let named: Vec<&str> = named.collect();
        let effects = findings(
            &problem,
            &selection,
            &correction.steps,
            &correction.closes,
            numbers::beyond_tolerance(&correction.numbers, &named, most_sure),
            comparison,
            most_sure,
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
            stand_in,
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

/// The data that every fit shares, where the nominal model leaves a gap of `before`, in units of position.
fn problem(recording: &Recording, before: f64) -> Problem<'_> {
    let of = |horizon_s, quarter| Problem {
        recording,
        series: few(recording, horizon_s),
        priors: priors(recording),
        modelling: MODELLING_SHARE * before,
        quarter,
    };
    let quarter = of(0.25 * recording.horizon, None);
    of(recording.horizon, Some(Box::new(quarter)))
}

/// What is known before the search.
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

/// What is left of a search once all sets of effects that it met were measured alike, with what each of its effects closes.
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
    let refined = select::refined(&found, &problem, given, progress);
    progress(Stage::Shrink);
    if let Some((exact, mut refined)) = refined {
        let closed = closing_steps(&exact, &mut refined);
        if refined.rounds.len() > found.rounds.len() {
            return (exact, refined, closed);
        }
    }
    let closed = closing_steps(&problem, &mut found);
    (problem, found, closed)
}

/// Takes back the effects of which a number is one that no device has; says which and why.
fn without_implausible(
    problem: &Problem<'_>,
    selection: &mut Selection,
    mut closed: Closed,
) -> (Closed, Vec<Implausible>) {
    let mut all = Vec::new();
    loop {
        let base = selection.base();
        let mut places = selection.kept()..selection.rounds.len();
        let found = places.find_map(|place| {
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

/// What predicts without any correction.
struct Baseline {
    /// Gap and floor of the nominal model.
    nominal: Gap,
    /// Squares of each window that it leaves.
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

    /// How far a gap closes above a floor, by its shrink and the 95 % interval of that.
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
    /// What each effect closes, with its 95 % interval.
    closes: Vec<[f64; 3]>,
    numbers: Vec<NumberFinding>,
    /// Squares of each window that it leaves on data that its fit has not seen.
    after: Vec<f64>,
    /// Lowest shrink with 97.5 % probability on this recording's windows.
    lowest: f64,
}

impl Correction {
    /// The nominal model.
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

    /// The effects of a selection, with the numbers of the model where they have gone.
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
        // A model that could not come below what there was before closes nothing of it.
        let (floor, floor_of) = if measured.floor < before {
            (measured.floor, FloorOf::CorrectedModel)
        } else {
            (baseline.nominal.floor, FloorOf::NominalModel)
        };
        // What the model leaves of the very recording that it was fitted to is the least that it leaves of others.
        if before > floor {
            Step::bounded(&mut steps, (before - measured.before) / (before - floor));
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

    /// The numbers of the model where the null has moved them, if that surely closes something.
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
            ..none
        }
    }

    /// The reason to reject it, if there is one; what two columns show needs no prediction.
    fn rejection(&self, model_free: &ModelFree, selection: &Selection) -> Option<Rejection> {
        let is_judged = !selection.rounds.is_empty() && !selection.given;
        // Nothing was held out of what shows in a window or two.
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

/// What each effect of a selection closes, with its 95 % interval: its part of the whole, or where the first was given, its step.
fn closes(selection: &Selection, steps: &[Step], parts: &[Attributed]) -> Vec<[f64; 3]> {
    let places = 0..selection.rounds.len();
    let closes = places.map(|place| {
        let own = Cause::Effect(selection.base() + place);
        let part = parts.iter().find(|part| part.cause == own);
        match part {
            Some(part) if !selection.given => part.shrink,
            _ => steps[place].own,
        }
    });
    closes.collect()
}
