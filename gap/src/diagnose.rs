//! The diagnosis: how large the gap is, where it lies, which effects cause it, how far it shrinks.

use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Closing, Diagnosis, Estimate, Finding, Tried, Verdict};
use crate::fit::Fit;
use crate::floor::FLOOR_DOUBT;
use crate::hypothesis::nudges;
use crate::measure::{exceeds, measure};
use crate::problem::{Part, Problem};
use crate::select::{self, Given, Round, Selection};
use crate::series;
use crate::shrink::{resampled, shrink};
use crate::stage::Stage;
use crate::stand_in::StandIn;
use crate::strain::{self, Strain};
use crate::{comparison, experiment, locate};
use host_sim::device::Device;
use recording::Recording;
use std::time::Instant;

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

/// The nominal model with its numbers moved and effects on top.
#[derive(Clone, Debug)]
pub struct CorrectedModel {
    /// The numbers.
    pub model: recording::Model,
    /// The effects, with all their parameters, in the order in which they are installed.
    pub effects: Vec<CorrectedEffect>,
}

/// An effect of a corrected model.
#[derive(Clone, Debug)]
pub struct CorrectedEffect {
    /// Kind and numbers.
    pub effect: host_sim::effects::Effect,
    /// Side of the transmission on which the position sensor sits.
    pub sensor_on_load: bool,
}

impl CorrectedModel {
    /// The device that it describes.
    pub fn device(&self) -> Device {
        let mut device = Device::nominal(&self.model);
        for corrected in &self.effects {
            device.sensor_on_load = corrected.sensor_on_load;
            corrected.effect.install(&mut device);
        }
        device
    }
}

/// Share of the robust excess that may be left where the gap is at its floor: a wrong name for a hum may come that near
/// by the few windows that are large.
const MOST_MISSING_AT_FLOOR: f64 = 0.25;
/// Standard errors of gain beyond which the number of windows no longer limits the confidence.
const SURE: f64 = 6.0;
/// Probability that two columns and the dynamics are not wrong together.
const COMPARED: f64 = 0.97;
/// Probability that a name is right where something else is missing, for which it may stand in: of 21 such names on five
/// blind sets 17 were right.
const SURE_IN_PART: f64 = 0.85;
/// What an effect rests on.
const PREDICTION: &str = "prediction";
const SENSOR_COMPARISON: &str = "sensor_comparison";
/// Share of the gap that a further effect must close, or of what those before it leave.
const LEAST_SHRINK: f64 = 0.05;
const LEAST_SHRINK_OF_REST: f64 = 0.5;
/// Or this share of the robust excess, and surely something of the gap or nearly all that was left of the excess: a few windows
/// in which a hidden state is wrong may be most of the gap.
const LEAST_TYPICAL_SHRINK: f64 = 0.2;

fn few(recording: &Recording, horizon_s: f64) -> Vec<series::Series> {
    series::thinned(series::coarse(recording, horizon_s), series::MOST_SAMPLES)
}

/// Diagnoses a recording.
pub fn diagnose(recording: &Recording, options: &Options) -> Outcome {
    let started = Instant::now();
    let progress = options.progress;
    progress(Stage::Windows);
    let problem = |horizon_s, quarter| Problem {
        recording,
        series: few(recording, horizon_s),
        nudges: nudges(recording),
        quarter,
    };
    let quarter = problem(0.25 * recording.horizon, None);
    let problem = problem(recording.horizon, Some(Box::new(quarter)));
    let comparison = comparison::compare(&problem, |own| few(own, own.horizon));
    let without = options.without.iter().map(String::as_str);
    let cleared = comparison.iter().flat_map(|c| c.excluded());
    let no_pendulum = recording.units.is_length() && recording.model.gravity == 0.0;
    let linear = no_pendulum.then_some("gravity");
    let excluded: Vec<&str> = without.chain(cleared).chain(linear).collect();
    let like = comparison.as_ref().and_then(Comparison::like);
    let like = like.filter(|like| !excluded.contains(&like.kind.name));
    let nominal = Device::nominal(&recording.model);
    // Where noise and restarts alone leave as much, there is hardly anything to name.
    let (before, is_gap) = exceeds(recording, &nominal, FLOOR_DOUBT);
    let given = Given {
        is_gap,
        measured: like.map(Match::term),
        certain: comparison.as_ref().is_some_and(Comparison::is_certain),
        excluded,
    };
    let mut selection = select::select(&problem, &given, progress);

    let kept = usize::from(selection.given);
    if selection.rounds.len() > kept && selection.leaves_most(&problem) {
        selection.withdraw(kept);
    }

    progress(Stage::Shrink);
    let mut left = left_by_each(&problem, &selection);
    let mut steps = closings(&problem, selection.fit(), &left);
    while let Some(idle) = (kept.max(1)..steps.len()).find(|&i| is_idle(&selection, i, &steps[i])) {
        selection.withdraw_one(&problem, idle);
        if idle < selection.rounds.len() {
            left = left_by_each(&problem, &selection);
        } else {
            left.truncate(idle + 1);
        }
        steps = closings(&problem, selection.fit(), &left);
    }

    if kept == 0 && are_vain(&steps, selection.left(selection.fit())) {
        steps.clear();
        selection.withdraw(0);
    }

    let model = corrected(&problem, selection.fit());
    let (after, _) = measure(recording, &model.device());
    let floor = after.floor.min(before);
    let total = steps.last().map_or([0.0; 3], |step| step.total);
    let closing = Closing {
        before,
        floor,
        after: before - total[0] * (before - floor),
        shrink: total[0],
        shrink_interval: [total[1], total[2]],
        unit: recording.units.position.clone(),
    };

    let most_missing = if closing.after <= FLOOR_DOUBT * floor {
        MOST_MISSING_AT_FLOOR
    } else {
        select::MOST_LEFT_EXPLAINED
    };
    let stand_in = StandIn::of(&problem, selection.fit(), kept);
    let verdict = if selection.rounds.is_empty() {
        let is_hidden = || selection.null_leaves_at_most(select::QUIET_GAP, &problem);
        if selection.quiet || (!selection.plain && is_hidden()) {
            Verdict::NoGap
        } else {
            Verdict::Unexplained
        }
    } else if closing.is_closed()
        && selection.missing(&problem, selection.fit()) <= most_missing
        && stand_in.is_none()
    {
        Verdict::Explained
    } else {
        Verdict::PartlyExplained
    };

    let mut effects = findings(&problem, &selection, &steps, comparison.as_ref());
    if verdict == Verdict::PartlyExplained {
        for effect in effects.iter_mut().filter(|e| e.basis == PREDICTION) {
            effect.confidence = effect.confidence.min(SURE_IN_PART);
        }
    }
    let names: Vec<&str> = effects.iter().map(|e| e.name).collect();
    progress(Stage::Where);
    let regions = if verdict == Verdict::NoGap {
        Vec::new()
    } else {
        locate::regions(&problem, &selection.null, comparison.as_ref())
    };
    progress(Stage::NextExperiment);
    let next_experiment = experiment::separating(&problem, &selection);
    let disagreement = comparison
        .iter()
        .filter_map(|c| c.line(&recording.units.position));
    let oddities = recording.oddities.iter().map(ToString::to_string);
    let bounds = selection.fit().at_bounds(&problem.nudges);
    let bounds = bounds.iter().map(ToString::to_string);
    let doubt = stand_in.iter().map(ToString::to_string);
    let rounds = selection.rounds.iter().zip(&steps);
    let small = rounds.filter(|(_, step)| step.own[0] < LEAST_SHRINK);
    let strains = small.filter_map(|(round, _)| Strain::of(round, &problem.nudges));
    let strains = strains.map(|strain| strain.to_string());
    let warnings = oddities.chain(disagreement).chain(bounds);
    let warnings = warnings.chain(doubt).chain(strains);
    let diagnosis = Diagnosis {
        format: 1,
        verdict,
        regions,
        candidates: tried(&problem, &selection, &names),
        gap: closing,
        effects,
        next_experiment,
        warnings: warnings.collect(),
        elapsed_s: started.elapsed().as_secs_f64(),
    };
    Outcome { diagnosis, model }
}

fn corrected(problem: &Problem<'_>, fit: &Fit) -> CorrectedModel {
    let effects = fit
        .hypothesis
        .parts(&fit.x)
        .map(|(term, own)| CorrectedEffect {
            effect: host_sim::effects::Effect {
                kind: term.kind,
                values: term.at(own),
            },
            sensor_on_load: term.sensor_on_load,
        });
    let effects = effects.collect();
    CorrectedModel {
        model: fit
            .hypothesis
            .nudged(&problem.recording.model, &problem.nudges, &fit.x),
        effects,
    }
}

/// Shrink of one effect and of all up to it: value and 95 % interval; and of what those before it left.
struct Step {
    own: [f64; 3],
    of_rest: f64,
    total: [f64; 3],
    /// True if it leaves no more than a right model may.
    is_at_floor: bool,
    /// True if it surely leaves less than those before it.
    is_sure: bool,
}

/// Squares of each window that the nominal model leaves, and that are left with each effect in turn, on windows that the fits
/// have not seen.
fn left_by_each(problem: &Problem<'_>, selection: &Selection) -> Vec<Vec<f64>> {
    let bare = Fit {
        x: vec![0.0; problem.nudges.len()],
        ..selection.null.clone()
    };
    let nominal = problem.window_squares(&bare, Part::All);
    let left = selection.rounds.iter().map(|round| {
        if round.rivals[0].is_event() {
            problem.window_squares(&round.so_far, Part::All)
        } else {
            problem.unseen(&round.so_far, |fit, half| problem.window_squares(fit, half))
        }
    });
    [nominal].into_iter().chain(left).collect()
}

/// The shrinks of the effects in their order, down to the floor of the `fit` with all of them.
fn closings(problem: &Problem<'_>, fit: &Fit, left: &[Vec<f64>]) -> Vec<Step> {
    let [nominal, _, ..] = left else {
        return Vec::new();
    };
    let floor = problem.floor_squares(fit);
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let is_at_floor = |left: &[f64]| sum(left) <= FLOOR_DOUBT.powi(2) * sum(&floor);
    let steps = left.iter().zip(&left[1..]).map(|(before, after)| {
        let of_rest = shrink(before, after, &floor, before)[0];
        Step {
            own: shrink(before, after, &floor, nominal),
            of_rest: if is_at_floor(before) { 0.0 } else { of_rest },
            total: shrink(nominal, after, &floor, nominal),
            is_at_floor: is_at_floor(after),
            is_sure: resampled(before.len(), |sum| sum(before) - sum(after))[1] > 0.0,
        }
    });
    steps.collect()
}

/// True if the effect `i`, which is not the first, does not close the gap by itself, however well it suits the robust cost.
fn is_idle(selection: &Selection, i: usize, step: &Step) -> bool {
    if step.own[0] >= LEAST_SHRINK {
        return false;
    }
    let winner = &selection.rounds[i].rivals[0];
    // What only drags for a while may stand in for a little of anything.
    if winner.name == "contact" && !select::is_stiff(&winner.fit) {
        return true;
    }
    let [before, after] = [i - 1, i].map(|k| selection.left(&selection.rounds[k].so_far));
    let is_real = step.is_sure || after <= select::MOST_LEFT_EXPLAINED;
    let typical = before - after >= LEAST_TYPICAL_SHRINK && is_real;
    // Where a restart falls on a jump, a right model leaves as much: that window may be most of what is left.
    let halves = after <= (1.0 - LEAST_SHRINK_OF_REST) * before;
    let jumps = winner.name == "lost_counts" && winner.is_event();
    let jumps = jumps && (step.is_at_floor || halves);
    let finishes = step.of_rest >= LEAST_SHRINK_OF_REST;
    let relieves = strain::is_relieved(&selection.rounds[i]);
    !finishes && !typical && !jumps && !relieves
}

/// True if effects that leave `left_open` of the excess leave the gap no smaller than it was, or may do so and leave most of
/// the excess; or if several leave much of it and each of them may close nothing: of 415 such diagnoses two did, with no right
/// name.
fn are_vain(steps: &[Step], left_open: f64) -> bool {
    let Some([value, low, _]) = steps.last().map(|step| step.total) else {
        return false;
    };
    let closes_nothing = value <= 0.0 || low <= 0.0 && left_open > select::MOST_LEFT;
    let none_is_sure = steps.len() > 1 && steps.iter().all(|step| step.own[1] <= 0.0);
    closes_nothing || none_is_sure && left_open > select::MOST_LEFT_EXPLAINED
}

fn findings(
    problem: &Problem<'_>,
    selection: &Selection,
    steps: &[Step],
    comparison: Option<&Comparison>,
) -> Vec<Finding> {
    let fit = selection.fit();
    let units = &problem.recording.units;
    let fitted = fit.hypothesis.parts(&fit.x);
    let fitted = fitted.zip(fit.hypothesis.parts(&fit.std));
    let mut all = Vec::new();
    for ((round, step), ((term, x), (_, std))) in selection.rounds.iter().zip(steps).zip(fitted) {
        let values = term.at(x);
        let mut parameters = std::collections::BTreeMap::new();
        for (i, value) in values.iter().enumerate() {
            let quantity = term.kind.parameter(i).quantity;
            let std = term.spread(i, x, std);
            let name = term.kind.value_name(i, values.len());
            let unit = quantity.unit(&units.position, &units.input);
            parameters.insert(
                name,
                Estimate {
                    value: *value,
                    std,
                    unit,
                },
            );
        }
        all.push(Finding {
            name: term.kind.name,
            channel: term.kind.channel.name(),
            confidence: confidence(round, selection.perfect.level),
            not_separable_from: select::ties(round),
            basis: PREDICTION,
            parameters,
            shrink: step.own[0],
            shrink_interval: [step.own[1], step.own[2]],
        });
    }
    all.sort_by(|a, b| b.shrink.total_cmp(&a.shrink));
    let like = comparison.and_then(Comparison::like);
    for finding in &mut all {
        if let Some(like) = like.filter(|like| like.kind.name == finding.name) {
            compared(finding, like, selection.given);
        }
    }
    if selection.given {
        // What two columns show comes before what only predicts.
        all.sort_by_key(|finding| finding.basis != SENSOR_COMPARISON);
    }
    all
}

/// Rests an effect on the comparison of two columns, from which it was `given` or that it was found to agree with.
fn compared(finding: &mut Finding, like: &Match, given: bool) {
    let [shrink, low, high] = like.shrink;
    finding.basis = SENSOR_COMPARISON;
    finding.shrink = shrink;
    finding.shrink_interval = [low, high];
    if given {
        finding.confidence = COMPARED;
        finding.not_separable_from.clone_from(&like.ties);
    }
}

/// Probability that the winner of a round is right: from how much better it is than the next that is not more of the
/// same, and how little it leaves.
fn confidence(round: &Round, perfect: f64) -> f64 {
    let known = &round.known;
    let winner = &round.rivals[0];
    let gain = known.costs.level() - winner.fit.costs.level();
    let next = select::others(round).next();
    let next = next.map_or(known.costs.level(), |r| r.fit.costs.level());
    let margin = ((next - winner.fit.costs.level()) / gain.max(1e-9)).clamp(0.0, 1.0);
    let left = ((winner.fit.costs.level() - perfect)
        / (known.costs.level() - perfect).max(f64::MIN_POSITIVE))
    .clamp(0.0, 1.0);
    let sure = (round.significance / SURE).min(1.0);
    (0.55 + 0.8 * sure * margin.sqrt() * (1.0 - 0.6 * left)).clamp(0.3, 0.99)
}

fn tried(problem: &Problem<'_>, selection: &Selection, named: &[&str]) -> Vec<Tried> {
    let mut all: Vec<Tried> = Vec::new();
    for round in selection.rounds.iter().chain(&selection.last) {
        let winner = &round.rivals[0];
        let stands_alone = named.is_empty() || named.contains(&winner.name);
        for rival in &round.rivals {
            if named.contains(&rival.name) || all.iter().any(|t| t.name == rival.name) {
                continue;
            }
            let gain = round.known.costs.level() - rival.fit.costs.level();
            let why_not = if gain <= 0.0 {
                "no gain".to_owned()
            } else if rival.name == winner.name {
                "no gain on held-out data".to_owned()
            } else if stands_alone {
                format!("gains less than {}", winner.name)
            } else {
                format!("earns no place beside {}", named.join(" and "))
            };
            all.push(Tried {
                name: rival.name,
                after: problem.plain_gap(&problem.series, &rival.fit),
                why_not,
            });
        }
    }
    all.sort_by(|a, b| a.after.total_cmp(&b.after));
    all
}
