//! A diagnosis of a messy case against its truth.
//!
//! Every cause that is present is there, however small, under its own name. A stated number that is off is there under the
//! name of its effect. `numbers` of a diagnosis are findings but no names: one that moved without being off is not counted
//! as a wrong name; one that was off, and is among them, is found.

use super::judge::Outcome;
use super::summary::Row;
use crate::case::effect_of;
use crate::diagnosis::Diagnosis;
use crate::scenario::VOCABULARY;
use crate::truth::{Kind, Truth};

/// From this confidence on a name must be there.
pub(super) const SURE: f64 = 0.7;

/// Names that are right: all causes that are there and have a name.
pub(super) fn there<'a>(truth: &'a Truth, withheld: Option<&str>) -> Vec<&'a str> {
    let names = truth.effects.iter().map(|effect| effect.name.as_str());
    names
        .filter(|name| VOCABULARY.contains(name) && Some(*name) != withheld)
        .collect()
}

/// Whether the dominant cause has a name, and whether that comes first, is named or called not separable; then whether the
/// answer is right.
pub(super) fn judge(
    outcome: &mut Outcome,
    truth: &Truth,
    diagnosis: &Diagnosis,
    withheld: Option<&str>,
) {
    let there = there(truth, withheld);
    let sure = diagnosis
        .effects
        .iter()
        .filter(|found| found.confidence >= SURE);
    outcome.sure_names = sure.clone().count();
    outcome.not_there = sure
        .map(|found| found.name.clone())
        .filter(|name| !there.contains(&name.as_str()))
        .collect();
    let dominant = truth.effects.first().map(|effect| effect.name.as_str());
    let Some(dominant) = dominant.filter(|name| there.contains(name)) else {
        outcome.nameable = false;
        (outcome.first, outcome.in_class) = (false, false);
        outcome.right = outcome.not_there.is_empty();
        return;
    };
    let moved = |name: &str| effect_of(name) == Some(dominant);
    let first = diagnosis.effects.first();
    outcome.first = match diagnosis.numbers.first() {
        Some(number) if moved(&number.name) => {
            // The number is the first finding if nothing that is named closes more.
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

/// The table's rows on messy cases; none if there is no such case.
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
