//! Scores a diagnosis of a messy case.
//!
//! Every cause that was hidden counts as present under its own name, however small it is. A wrong stated number counts as
//! present under the name of the effect that its error equals. The `numbers` of a diagnosis are findings but not names. A
//! changed number that was right is not counted as a wrong name. A changed number that was wrong is counted as found.

use super::judge::Outcome;
use super::summary::Row;
use crate::case::effect_of;
use crate::diagnosis::Diagnosis;
use crate::scenario::VOCABULARY;
use crate::truth::{Kind, Truth};

/// A name with at least this confidence must be present.
pub(super) const SURE: f64 = 0.7;

/// All causes that are present and have a name in the vocabulary.
pub(super) fn present<'a>(truth: &'a Truth, withheld: Option<&str>) -> Vec<&'a str> {
    let names = truth.effects.iter().map(|effect| effect.name.as_str());
    names
        .filter(|name| VOCABULARY.contains(name) && Some(*name) != withheld)
        .collect()
}

/// Scores the dominant cause: whether it has a name, comes first, is named or listed as not separable, and whether the
/// answer is right.
pub(super) fn judge(
    outcome: &mut Outcome,
    truth: &Truth,
    diagnosis: &Diagnosis,
    withheld: Option<&str>,
) {
    let present = present(truth, withheld);
    let sure = diagnosis
        .effects
        .iter()
        .filter(|found| found.confidence >= SURE);
    outcome.sure_names = sure.clone().count();
    outcome.not_there = sure
        .map(|found| found.name.clone())
        .filter(|name| !present.contains(&name.as_str()))
        .collect();
    let dominant = truth.effects.first().map(|effect| effect.name.as_str());
    let Some(dominant) = dominant.filter(|name| present.contains(name)) else {
        outcome.nameable = false;
        (outcome.first, outcome.in_class) = (false, false);
        outcome.right = outcome.not_there.is_empty();
        return;
    };
    let moved = |name: &str| effect_of(name) == Some(dominant);
    let first = diagnosis.effects.first();
    outcome.first = match diagnosis.numbers.first() {
        Some(number) if moved(&number.name) => {
            // The changed number is the first finding if no named effect closes more of the gap.
            let closes = first.and_then(|found| found.shrink).unwrap_or(0.0);
            first.is_none_or(|found| found.name == dominant)
                || number.shrink.is_some_and(|shrink| shrink >= closes)
        }
        _ => first.is_some_and(|found| found.name == dominant),
    };
    outcome.in_class = diagnosis.numbers.iter().any(|number| moved(&number.name))
        || diagnosis.effects.iter().any(|found| {
            found.name == dominant || found.not_separable_from.iter().any(|name| name == dominant)
        });
    outcome.all_named = false;
    outcome.silent = diagnosis.effects.is_empty() && diagnosis.numbers.is_empty();
    outcome.right = outcome.first;
}

/// The rows of the table for messy cases. Empty if there are none.
pub(super) fn rows(outcomes: &[Outcome]) -> Vec<Row> {
    let messy: Vec<&Outcome> = outcomes
        .iter()
        .filter(|outcome| outcome.kind == Kind::Messy)
        .collect();
    if messy.is_empty() {
        return Vec::new();
    }
    let nameable = || messy.iter().filter(|outcome| outcome.nameable);
    let sure = messy
        .iter()
        .flat_map(|outcome| (0..outcome.sure_names).map(|name| name < outcome.not_there.len()));
    vec![
        Row::at_least(
            "messy: first finding is the dominant cause",
            0.80,
            nameable().map(|o| o.first),
        ),
        Row::at_least(
            "messy: dominant named or not separable",
            0.90,
            nameable().map(|o| o.in_class),
        ),
        Row::at_most(
            "messy: cases with a name >= 0.7 not there",
            0.05,
            messy.iter().map(|o| !o.not_there.is_empty()),
        ),
        Row::at_most("messy: names >= 0.7 that are not there", 0.05, sure),
        Row::at_least(
            "messy: no name, dominant one outside vocabulary",
            0.90,
            messy.iter().filter(|o| !o.nameable).map(|o| o.right),
        ),
        Row::shown(
            "messy: nothing found though it has a name",
            nameable().map(|o| o.silent),
        ),
        Row::mean(
            "messy: names given on average",
            messy.iter().map(|o| o.names as f64),
        ),
    ]
}
