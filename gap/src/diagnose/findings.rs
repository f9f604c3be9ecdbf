//! The effects that the diagnosis names, with their confidence, and the other effects that were tried.

use super::prior_tension::relieves_tension;
use super::steps::{Step, is_redundant};
use crate::comparison::{Comparison, Match};
use crate::diagnosis::{Estimate, Finding, Tried, Verdict};
use crate::fit::problem::Problem;
use crate::instrument::timing::TimingDoubt;
use crate::plausible::Implausible;
use crate::select::{self, Round, Selection};
use indexmap::IndexMap;

/// Significance of the gain, in standard errors, beyond which the number of windows no longer limits the confidence.
const SIGNIFICANT: f64 = 6.0;
/// Confidence in an effect that both the comparison of two columns and the prediction show.
const SURE_BY_COMPARISON: f64 = 0.97;
/// Highest confidence if the gap is only partly explained, because the effect may stand for another cause.
const SURE_IN_PART: f64 = 0.85;
/// Highest confidence in a further effect that closes hardly anything by itself. Such an effect most often corrects the formula of the
/// effect before it.
const SURE_IF_SMALL: f64 = 0.5;
/// Highest confidence if the data contradict the stated timing of the input.
const SURE_IF_TIMING_IS_DOUBTED: f64 = 0.45;
/// The evidence for an effect.
pub(super) const PREDICTION: &str = "prediction";
const SENSOR_COMPARISON: &str = "sensor_comparison";

/// Highest confidence in an effect, by the verdict and by a doubt of the input timing. Effects that are fitted with a wrong timing
/// compensate it.
pub(super) fn confidence_limit(verdict: Verdict, timing: Option<&TimingDoubt>) -> f64 {
    match (verdict, timing) {
        (_, Some(_)) => SURE_IF_TIMING_IS_DOUBTED,
        (Verdict::PartlyExplained, None) => SURE_IN_PART,
        _ => 1.0,
    }
}

/// The findings: the effects of a selection, each with the shrink `closes` and its 95 % interval, and the moved model parameters
/// `numbers`. The finding that closes most comes first.
pub(super) fn findings(
    problem: &Problem<'_>,
    selection: &Selection,
    steps: &[Step],
    closes: &[[f64; 3]],
    numbers: Vec<Finding>,
    comparison: Option<&Comparison>,
    confidence_limit: f64,
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
        let is_redundant_small =
            step.is_small() && !relieves_tension(round) && is_redundant(problem, selection, place);
        let confidence_limit = confidence_limit.min(if is_redundant_small {
            SURE_IF_SMALL
        } else {
            1.0
        });
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
            confidence: confidence(round, selection.expected.level).min(confidence_limit),
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
            base_on_comparison(finding, like, selection.given);
        }
    }
    all
}

/// Bases a finding on the comparison of two columns. Either the effect was `given` by the comparison, or the comparison agrees with it.
fn base_on_comparison(finding: &mut Finding, like: &Match, given: bool) {
    let [shrink, low, high] = like.shrink;
    finding.basis = SENSOR_COMPARISON;
    finding.shrink = shrink;
    finding.shrink_interval = [low, high];
    if given {
        finding.confidence = SURE_BY_COMPARISON;
        finding.not_separable_from.clone_from(&like.ties);
    }
}

/// Confidence in the winner of a round: from its lead over the next effect that is not equivalent, and from the excess that it leaves.
pub(super) fn confidence(round: &Round, expected: f64) -> f64 {
    if let Some(measured) = &round.measured {
        return measured.confidence;
    }
    let known = &round.known;
    let winner = &round.rivals[0];
    let gain = known.costs.level() - winner.fit.costs.level();
    let next = select::others(round).next();
    let next = next.map_or(known.costs.level(), |r| r.fit.costs.level());
    let lead = next - winner.fit.costs.level() - select::chance_gain(&winner.fit);
    let margin = (lead / gain.max(1e-9)).clamp(0.0, 1.0);
    let excess_left = ((winner.fit.costs.level() - expected)
        / (known.costs.level() - expected).max(f64::MIN_POSITIVE))
    .clamp(0.0, 1.0);
    let sure = (round.acceptance.significance / SIGNIFICANT).min(1.0);
    (0.55 + 0.8 * sure * margin.sqrt() * (1.0 - 0.6 * excess_left)).clamp(0.3, 0.99)
}

/// The effects that were tried and not `named`, smallest residual first.
pub(super) fn tried(
    problem: &Problem<'_>,
    selection: &Selection,
    named: &[&str],
    implausible: &[Implausible],
) -> Vec<Tried> {
    let residual = |fit| problem.plain_gap(&problem.series, fit);
    let mut all: Vec<Tried> = Vec::new();
    for round in selection.rounds.iter().chain(&selection.last) {
        let winner = &round.rivals[0];
        let stands_alone = named.is_empty() || named.contains(&winner.name);
        for rival in &round.rivals {
            if named.contains(&rival.name) || all.iter().any(|t| t.name == rival.name) {
                continue;
            }
            let gain = round.known.costs.level() - rival.fit.costs.level();
            let after = residual(&rival.fit);
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
                format!("adds too little to {}", named.join(" and "))
            } else if after >= residual(&winner.fit) {
                format!("leaves more than {}", winner.name)
            } else {
                format!("predicts more windows worse than {}", winner.name)
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
