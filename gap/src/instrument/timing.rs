//! Detects whether the data contradict the stated sampling or timing of `input`.

use crate::effects::{self, Family, Identification};
use crate::fit::Fit;
use crate::fit::hypothesis::{Hypothesis, INPUT_TIME, priors};
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{WHITE, mean_and_error};
use crate::term::Term;
use crate::windows::series;
use crate::windows::statistics::rms;
use host_sim::effects::Channel;
use recording::{InputSampling, Recording};
use std::fmt;

/// Least significance of the gain on held-out windows, in standard errors. Chance reaches it once in 700 recordings.
const LEAST_SIGNIFICANCE: f64 = 3.0;
/// Least relative standard deviation of the model parameters, so that they can adapt to either timing.
const WIDE_TOLERANCE: f64 = 0.5;
/// Coulomb friction, and viscous friction at the rms speed, of a model without them, as a share of the rms torque.
const SOME_FRICTION: f64 = 0.02;
/// Number of samples that suffices.
const MOST_SAMPLES: usize = 10_000;
const ITERATIONS: usize = 12;

/// The timing that the data prefer to the stated one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TimingDoubt {
    preferred: Timing,
    /// Median time between rows, s.
    row_s: f64,
    /// Gap with the model parameters free, with the stated and with the preferred timing, in position units.
    gaps: [f64; 2],
    unit: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Timing {
    Stated,
    Sampled(InputSampling),
    /// The input acts later by a time, s, with its standard deviation.
    Later(f64, f64),
}

/// A timing on trial: the cost of each held-out window, and the gap.
struct Trial {
    timing: Timing,
    costs: Vec<f64>,
    gap: f64,
}

/// The trials of one hypothesis: the stated timing, and the best timing with a significantly lower cost.
struct Trials {
    stated: Trial,
    best: Option<Trial>,
}

/// Returns a doubt if another input sampling, or an unstated shift of at most one row, has a significantly lower cost on held-out windows
/// with the model parameters free. A wrong timing and the effects that were `found` may imitate each other. So the timing must also be
/// better together with these effects, or be no worse in their place.
pub(crate) fn doubt(problem: &Problem<'_>, found: &Fit) -> Option<TimingDoubt> {
    let recording = with_wide_tolerances(problem);
    let row_s = series::median_period(&recording.runs.first()?.time);
    let bare = Hypothesis { terms: Vec::new() };
    let Trials { stated, best } = trials(problem, &recording, &bare, &[], row_s);
    let best = best?;
    let parts = found.hypothesis.parts(&found.x);
    // Delays and lags act like another timing, so they are left out.
    let is_delay = |term: &Term| effects::of(term.kind.name).family() == Some(Family::Lateness);
    let others = parts.filter(|(term, _)| !is_delay(term));
    let (terms, own): (Vec<Term>, Vec<&[f64]>) =
        others.map(|(term, own)| (term.clone(), own)).unzip();
    if !terms.is_empty() {
        let with_effects = trials(
            problem,
            &recording,
            &Hypothesis { terms },
            &own.concat(),
            row_s,
        );
        let agrees = |other: &Trial| other.timing.is_like(best.timing);
        let is_no_worse_instead = gain(&with_effects.stated, &best).0 >= 0.0;
        if !with_effects.best.as_ref().is_some_and(agrees) && !is_no_worse_instead {
            return None;
        }
    }
    Some(TimingDoubt {
        preferred: best.timing,
        row_s,
        gaps: [stated.gap, best.gap],
        unit: recording.units.position.clone(),
    })
}

/// The input timing with a significantly lower cost than the stated one together with the effects that were `found`, if any. No timing is
/// tried if a time is stated as uncertain, or if one of the effects is a delay or a lag, because that time is fitted anyway.
pub(crate) fn preferred(problem: &Problem<'_>, found: &Fit) -> Option<TimingDoubt> {
    let recording = problem.recording;
    let mut terms = found.hypothesis.terms.iter();
    let is_delay = |term: &Term| effects::of(term.kind.name).family() == Some(Family::Lateness);
    if recording.runs.iter().any(|run| run.input_time_std > 0.0) || terms.any(is_delay) {
        return None;
    }
    let row_s = series::median_period(&recording.runs.first()?.time);
    let own: Vec<&[f64]> = found.hypothesis.parts(&found.x).map(|(_, x)| x).collect();
    let free = with_wide_tolerances(problem);
    let trials = trials(problem, &free, &found.hypothesis, &own.concat(), row_s);
    let best = trials.best?;
    Some(TimingDoubt {
        preferred: best.timing,
        row_s,
        gaps: [trials.stated.gap, best.gap],
        unit: recording.units.position.clone(),
    })
}

/// The recording with an unknown delay between input and position. Its standard deviation is one row.
pub(crate) fn within_a_row(recording: &Recording) -> Recording {
    let rows_s = recording
        .runs
        .iter()
        .map(|run| series::median_period(&run.time));
    // All runs have the same delay, even if their rows have different periods.
    let longest_s = rows_s.fold(0.0, f64::max);
    let mut recording = recording.clone();
    for run in &mut recording.runs {
        run.input_time_std = longest_s;
    }
    recording
}

/// Mean decrease of the cost per window from one trial to another, and its standard error.
fn gain(stated: &Trial, other: &Trial) -> (f64, f64) {
    let gains = stated.costs.iter().zip(&other.costs).map(|(a, b)| a - b);
    mean_and_error(&gains.collect::<Vec<f64>>())
}

/// The trials for the effects of a hypothesis, started at the coordinates `own`.
fn trials(
    problem: &Problem<'_>,
    recording: &Recording,
    hypothesis: &Hypothesis,
    own: &[f64],
    row_s: f64,
) -> Trials {
    let run_trial =
        |recording: &Recording, timing| trial(problem, recording, hypothesis, own, timing);
    let stated = run_trial(recording, Timing::Stated);
    let (level, error) = mean_and_error(&stated.costs);
    if level <= WHITE + LEAST_SIGNIFICANCE * error {
        return Trials { stated, best: None };
    }
    let mut resampled = recording.clone();
    let mut sampled = InputSampling::Mean;
    for run in &mut resampled.runs {
        run.input_sampling = match run.input_sampling {
            InputSampling::Mean => InputSampling::Point,
            InputSampling::Point => InputSampling::Mean,
        };
        sampled = run.input_sampling;
    }
    let mut all = vec![run_trial(&resampled, Timing::Sampled(sampled))];
    // A timing with a stated uncertainty is fitted in any case.
    if recording.runs.iter().all(|run| run.input_time_std == 0.0) {
        let mut shifted = recording.clone();
        for run in &mut shifted.runs {
            run.input_time_std = row_s;
        }
        let shifted = run_trial(&shifted, Timing::Later(0.0, 0.0));
        all.extend(Some(shifted).filter(|trial| trial.timing.is_within(row_s)));
    }
    let mut sure = all.into_iter().filter(|trial| {
        let (gain, error) = gain(&stated, trial);
        gain > LEAST_SIGNIFICANCE * error && trial.gap < stated.gap
    });
    // Another sampling is a shift of half a row without a fitted parameter. A fitted shift is preferred to it only if its cost is
    // significantly lower.
    let best = sure.next().map(|first| {
        let better = sure.find(|other| {
            let (gain, error) = gain(&first, other);
            gain > LEAST_SIGNIFICANCE * error
        });
        better.unwrap_or(first)
    });
    Trials { stated, best }
}

fn trial(
    problem: &Problem<'_>,
    recording: &Recording,
    hypothesis: &Hypothesis,
    own: &[f64],
    timing: Timing,
) -> Trial {
    let problem = Problem {
        recording,
        series: series::some_coarse(recording, recording.horizon, MOST_SAMPLES),
        priors: priors(recording),
        modelling: problem.modelling,
        objective: problem.objective,
        quarter: None,
    };
    let mut x = vec![0.0; problem.priors.len()];
    x.extend(own);
    let fit = problem.fit(hypothesis, x, Part::All, ITERATIONS);
    let costs = problem.held_out(&fit, |fit, part| {
        let costs = problem.costs(&fit.hypothesis, &fit.x, part);
        (0..costs.per_sample.len()).map(|w| costs.log(w)).collect()
    });
    let shift = problem.priors.iter().position(|n| n.name == INPUT_TIME);
    let timing = match (timing, shift) {
        (Timing::Later(..), Some(i)) => {
            let std_s = problem.priors[i].value;
            Timing::Later(std_s * fit.x[i], std_s * fit.std[i])
        }
        _ => timing,
    };
    Trial {
        timing,
        costs,
        gap: problem.plain_gap(&problem.series, &fit),
    }
}

/// The recording with a model of wide tolerances. Frictions of zero get a small value, so that they can increase.
fn with_wide_tolerances(problem: &Problem<'_>) -> Recording {
    let mut recording = problem.recording.clone();
    let model = &mut recording.model;
    let inputs: Vec<f64> = problem
        .series
        .iter()
        .flat_map(|s| s.input.iter().copied())
        .collect();
    let torque = model.ratio.abs() * rms(&inputs);
    let speeds = problem
        .series
        .iter()
        .flat_map(|s| s.velocity.iter().copied());
    let speed = rms(&speeds.collect::<Vec<f64>>());
    let some = SOME_FRICTION * torque;
    if model.coulomb == 0.0 {
        model.coulomb = some;
    }
    if model.viscous == 0.0 && speed > 0.0 {
        model.viscous = some / speed;
    }
    let numbers = effects::all().filter(|effect| effect.kind().channel != Channel::Actuation);
    for name in numbers.filter_map(Identification::replaces) {
        let known = recording.tolerance.iter().find(|(of, _)| *of == name);
        let stated = known.map_or(0.0, |(_, std)| std);
        recording.tolerance.set(name, stated.max(WIDE_TOLERANCE));
    }
    recording
}

impl Timing {
    /// True for another sampling, and for a significant shift of at most one row.
    fn is_within(self, row_s: f64) -> bool {
        match self {
            Self::Later(by_s, std_s) => {
                by_s.abs() <= row_s && by_s.abs() > LEAST_SIGNIFICANCE * std_s
            }
            Self::Sampled(_) | Self::Stated => true,
        }
    }

    /// True if both timings shift the input in the same direction. An input that was sampled at instants is half a row earlier.
    fn is_like(self, other: Self) -> bool {
        let earlier = |timing: Self| match timing {
            Self::Later(by_s, _) => by_s < 0.0,
            Self::Sampled(sampling) => sampling == InputSampling::Point,
            Self::Stated => false,
        };
        earlier(self) == earlier(other)
    }
}

impl fmt::Display for TimingDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            preferred,
            row_s,
            gaps: [stated, best],
            unit,
        } = self;
        let ms = |s: f64| 1e3 * s;
        match preferred {
            Timing::Stated => return Ok(()),
            Timing::Sampled(InputSampling::Point) => write!(
                f,
                "the data prefer an `input` that is the value at each row's instant, not the mean until the next: state `input_sampling = \"point\"` if it was sampled so"
            )?,
            Timing::Sampled(InputSampling::Mean) => write!(
                f,
                "the data prefer an `input` that is the mean until the next row, not the value at each row's instant: leave `input_sampling` out if it was averaged"
            )?,
            Timing::Later(by_s, std_s) => write!(
                f,
                "the data prefer an `input` that acts {:.2} ± {:.2} ms {} than its rows, which are {:.2} ms apart: state `input_time_std` if its time is uncertain, or `delay` if the drive has a dead time",
                ms(by_s.abs()),
                ms(*std_s),
                if *by_s < 0.0 { "earlier" } else { "later" },
                ms(*row_s),
            )?,
        }
        write!(
            f,
            "; with the model parameters free the gap is then {best:.3e} {unit}, and {stated:.3e} {unit} with the stated timing"
        )
    }
}
