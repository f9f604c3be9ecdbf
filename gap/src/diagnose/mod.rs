//! The diagnosis: how large the gap is, where it lies, which effects cause it, how far it shrinks.

mod corrected;
mod findings;
mod relief;
mod stand_in;
mod steps;
mod verdict;

use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Closing, Diagnosis, Verdict};
use crate::effects;
use crate::fit::hypothesis::nudges;
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::measure::{exceeds, measure};
use crate::select::{self, Given};
use crate::stage::Stage;
use crate::windows::series;
use crate::windows::unbroken::Unbroken;
use crate::{comparison, experiment, locate, ruler};
use corrected::corrected;
pub use corrected::{CorrectedEffect, CorrectedModel};
use findings::{findings, tried};
use host_sim::device::Device;
use recording::Recording;
use relief::Relief;
use stand_in::StandIn;
use std::time::Instant;
use steps::{Step, closing_steps};
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
    /// The corrected model.
    pub model: CorrectedModel,
}

/// Share of the gap that a right effect in another formulation may leave: less is not worth a name.
const MODELLING_SHARE: f64 = 0.01;

fn few(recording: &Recording, horizon_s: f64) -> Vec<series::Series> {
    series::thinned(series::coarse(recording, horizon_s), series::MOST_SAMPLES)
}

/// Diagnoses a recording.
pub fn diagnose(recording: &Recording, options: &Options) -> Outcome {
    let started = Instant::now();
    let progress = options.progress;
    progress(Stage::Windows);
    let Unbroken { recording, runs } = &Unbroken::of(recording);
    let nominal = Device::nominal(&recording.model);
    // Where noise and restarts alone leave as much, there is hardly anything to name.
    let (before, is_gap) = exceeds(recording, &nominal, FLOOR_DOUBT);
    let problem = |horizon_s, quarter| Problem {
        recording,
        series: few(recording, horizon_s),
        nudges: nudges(recording),
        modelling: MODELLING_SHARE * before,
        quarter,
    };
    let quarter = problem(0.25 * recording.horizon, None);
    let problem = problem(recording.horizon, Some(Box::new(quarter)));
    let comparison = comparison::compare(&problem, |own| few(own, own.horizon));
    let without = options.without.iter().map(String::as_str);
    let cleared = comparison.iter().flat_map(|c| c.excluded());
    let impossible = effects::all().filter(|effect| effect.is_impossible(recording));
    let impossible = impossible.map(|effect| effect.name());
    let excluded: Vec<&str> = without.chain(cleared).chain(impossible).collect();
    let like = comparison.as_ref().and_then(Comparison::like);
    let like = like.filter(|like| !excluded.contains(&like.kind.name));
    let given = Given {
        is_gap,
        measured: like.map(Match::term),
        certain: comparison.as_ref().is_some_and(Comparison::is_certain),
        excluded,
    };
    let selection = select::select(&problem, &given, progress);
    let measured = ruler::measured(&problem, &selection, &given, progress);
    let is_measured = measured.is_some();
    let (problem, mut selection) = measured.unwrap_or((problem, selection));
    let refined = if is_measured {
        None
    } else {
        selection.refined(&problem, &given, progress)
    };

    progress(Stage::Shrink);
    let refined = refined.and_then(|(exact, mut refined)| {
        let steps = closing_steps(&exact, &mut refined);
        (refined.rounds.len() > selection.rounds.len()).then_some((exact, refined, steps))
    });
    let (problem, selection, mut steps) = refined.unwrap_or_else(|| {
        let steps = closing_steps(&problem, &mut selection);
        (problem, selection, steps)
    });
    let model = corrected(&problem, selection.fit());
    let (after, _) = measure(recording, &model.device());
    // A model that could not come below what there was before closes nothing of it.
    let comes_below = after.floor < before || selection.rounds.is_empty();
    let floor = if comes_below {
        after.floor
    } else {
        measure(recording, &nominal).0.floor
    };
    // What the model leaves of the very recording that it was fitted to is the least that it leaves of others.
    if before > floor {
        Step::bounded(&mut steps, (before - after.before) / (before - floor));
    }
    let total = steps.last().map_or([0.0; 3], |step| step.total);
    let closing = Closing {
        before,
        floor,
        after: before - total[0] * (before - floor),
        shrink: total[0],
        shrink_interval: [total[1], total[2]],
        unit: recording.units.position.clone(),
    };

    let stand_in = StandIn::of(&problem, &selection);
    let verdict = verdict(&problem, &selection, &closing, stand_in);
    let effects = findings(&problem, &selection, &steps, comparison.as_ref(), verdict);
    let names: Vec<&str> = effects.iter().map(|e| e.name).collect();

    progress(Stage::Where);
    let regions = if verdict == Verdict::NoGap {
        Vec::new()
    } else {
        let mut regions = locate::regions(&problem, &selection.null, comparison.as_ref());
        for run in regions.iter_mut().filter_map(|region| region.run.as_mut()) {
            *run = runs[*run];
        }
        regions
    };
    progress(Stage::NextExperiment);
    let next_experiment = experiment::separating(&problem, &selection);

    let oddities = recording.warnings().into_iter();
    let disagreement = comparison
        .iter()
        .filter_map(|c| c.line(&recording.units.position));
    let stalls = selection.fit().stalls(&problem.nudges);
    let stalls = stalls.iter().map(ToString::to_string);
    let doubt = stand_in.iter().map(ToString::to_string);
    let small = selection.rounds.iter().zip(&steps);
    let small = small.filter(|(_, step)| step.is_small());
    let reliefs = small.filter_map(|(round, _)| Relief::of(round, &problem.nudges));
    let reliefs = reliefs.map(|relief| relief.to_string());
    let seen = effects.iter().filter(|effect| !effect.held_out);
    let seen = seen.map(|effect| {
        format!(
            "{} shows in too few windows for any to be held out: its shrink is on data that the fit has seen",
            effect.name
        )
    });
    let warnings = oddities.chain(disagreement).chain(stalls);
    let warnings: Vec<String> = warnings.chain(doubt).chain(reliefs).chain(seen).collect();
    let diagnosis = Diagnosis {
        format: 1,
        verdict,
        regions,
        candidates: tried(&problem, &selection, &names),
        gap: closing,
        effects,
        next_experiment,
        warnings,
        elapsed_s: started.elapsed().as_secs_f64(),
    };
    Outcome { diagnosis, model }
}
