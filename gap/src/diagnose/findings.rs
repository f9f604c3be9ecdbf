//! The effects that are named, how sure that is, and what was tried beside them.

use super::relief::is_relieved;
use super::steps::{Step, is_spare};
use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Estimate, Finding, Tried, Verdict};
use crate::fit::problem::Problem;
use crate::instrument::timing::TimingDoubt;
use crate::plausible::Implausible;
use crate::select::{self, Round, Selection};
use indexmap::IndexMap;

/// Standard errors of gain beyond which the number of windows no longer limits the confidence.
const SURE: f64 = 6.0;
/// Probability that two columns and the dynamics are not wrong together.
const COMPARED: f64 = 0.97;
/// Probability that a name is right where something else is missing, for which it may stand in: of 21 such names on five
/// blind sets 17 were right.
const SURE_IN_PART: f64 = 0.85;
/// Probability that the name of a further effect is right that hardly closes anything by itself: most often it makes up for
/// another form of the one before it. Of eleven such names on seven blind sets two were right.
const SURE_IF_SMALL: f64 = 0.5;
/// Probability that a name is right beside a timing that the data contradict: less than even.
const SURE_IF_TIMING_IS_DOUBTED: f64 = 0.45;
/// What an effect rests on.
pub(super) const PREDICTION: &str = "prediction";
const SENSOR_COMPARISON: &str = "sensor_comparison";

/// Probability that a name is right at most, by the verdict and by whether the data prefer another timing of the input than stated:
/// effects found with a wrong timing make up for it.
pub(super) fn most_sure(verdict: Verdict, timing: Option<&TimingDoubt>) -> f64 {
    match (verdict, timing) {
        (_, Some(_)) => SURE_IF_TIMING_IS_DOUBTED,
        (Verdict::PartlyExplained, None) => SURE_IN_PART,
        _ => 1.0,
    }
}

/// The effects of a selection, each of which `closes` so much of the gap with its 95 % interval, and those that are moved `numbers` of
/// the model; the one that closes most comes first.
pub(super) fn findings(
    problem: &Problem<'_>,
    selection: &Selection,
    steps: &[Step],
    closes: &[[f64; 3]],
    numbers: Vec<Finding>,
    comparison: Option<&Comparison>,
    most_sure: f64,
) -> Vec<Finding> {
    let fit = selection.fit();
    let units = &problem.recording.units;
    let stalls = fit.stalls(&problem.priors);
    let fitted = fit.hypothesis.parts(&fit.x);
    let fitted = fitted.zip(fit.hypothesis.parts(&fit.std));
    let fitted = fitted.skip(selection.base());
    let mut all = Vec::new();
    let rounds = selection.rounds.iter().zip(steps).zip(closes);
    for ((place, ((round, step), closes)), ((term, x), (_, std))) in rounds.enumerate().zip(fitted)
    {
        let is_aside =
            step.is_small() && !is_relieved(round) && is_spare(problem, selection, place);
        let most_sure = most_sure.min(if is_aside { SURE_IF_SMALL } else { 1.0 });
        let values = term.at(x);
        let mut parameters = IndexMap::new();
        for (i, value) in values.iter().enumerate() {
            let quantity = term.kind.parameter(i).quantity;
            let std = term.spread(i, x, std);
            let name = term.kind.value_name(i, values.len());
            let unit = quantity.unit(&units.position, &units.input);
            let is_stalled = stalls.iter().any(|s| s.is_of(term.kind.name, &name));
            let is_known = std > 0.0 && std.is_finite() && !is_stalled;
            let estimate = Estimate {
                value: *value,
                std: is_known.then_some(std),
                unit,
                is_fitted: std > 0.0,
            };
            parameters.insert(name, estimate);
        }
        all.push(Finding {
            name: term.kind.name,
            channel: term.kind.channel.name(),
            confidence: confidence(round, selection.expected.level).min(most_sure),
            not_separable_from: select::inseparable(round),
            basis: PREDICTION,
            held_out: !round.acceptance.by_few,
            parameters,
            shrink: closes[0],
            shrink_interval: [closes[1], closes[2]],
        });
    }
    all.extend(numbers);
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
pub(super) fn confidence(round: &Round, expected: f64) -> f64 {
    if let Some(measured) = &round.measured {
        return measured.confidence;
    }
    let known = &round.known;
    let winner = &round.rivals[0];
    let gain = known.costs.level() - winner.fit.costs.level();
    let next = select::others(round).next();
    let next = next.map_or(known.costs.level(), |r| r.fit.costs.level());
    let ahead = next - winner.fit.costs.level() - select::chance_gain(&winner.fit);
    let margin = (ahead / gain.max(1e-9)).clamp(0.0, 1.0);
    let left = ((winner.fit.costs.level() - expected)
        / (known.costs.level() - expected).max(f64::MIN_POSITIVE))
    .clamp(0.0, 1.0);
    let sure = (round.acceptance.significance / SURE).min(1.0);
    (0.55 + 0.8 * sure * margin.sqrt() * (1.0 - 0.6 * left)).clamp(0.3, 0.99)
}

/// What was tried and not `named`, those that leave least first.
pub(super) fn tried(
    problem: &Problem<'_>,
    selection: &Selection,
    named: &[&str],
    implausible: &[Implausible],
) -> Vec<Tried> {
    let left = |fit| problem.plain_gap(&problem.series, fit);
    let mut all: Vec<Tried> = Vec::new();
    for round in selection.rounds.iter().chain(&selection.last) {
        let winner = &round.rivals[0];
        let stands_alone = named.is_empty() || named.contains(&winner.name);
        for rival in &round.rivals {
            if named.contains(&rival.name) || all.iter().any(|t| t.name == rival.name) {
                continue;
            }
            let gain = round.known.costs.level() - rival.fit.costs.level();
            let after = left(&rival.fit);
            let withdrawn = implausible.iter().find(|one| one.effect == rival.name);
            let last = rival.fit.hypothesis.terms.len().saturating_sub(1);
            let no_device = withdrawn
                .cloned()
                .or_else(|| Implausible::of(problem, &rival.fit, last));
            let why_not = if let Some(no_device) = no_device {
                no_device.to_string()
            } else if gain <= 0.0 {
                "no gain".to_owned()
            } else if rival.name == winner.name {
                "no gain on held-out data".to_owned()
            } else if !stands_alone {
                format!("earns no place beside {}", named.join(" and "))
            } else if after >= left(&winner.fit) {
                format!("leaves more than {}", winner.name)
            } else {
                format!("misses more windows than {}", winner.name)
            };
            all.push(Tried {
                name: rival.name,
                after,
                why_not,
            });
        }
    }
    all.sort_by(|a, b| a.after.total_cmp(&b.after));
    all
}
