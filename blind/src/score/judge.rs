//! One diagnosis against its truth.

use serde::Serialize;

use super::messy;
use super::transfer::Kept;
use crate::diagnosis::{Diagnosis, Region, Verdict};
use crate::truth::{Kind, Place, Truth};

/// From this confidence on a name counts as confident.
pub(super) const CONFIDENT: f64 = 0.9;
/// How many regions of `where` are looked at.
const REGIONS: usize = 3;

/// Gaps on the fresh recording, in units of position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreshGaps {
    /// Of the nominal model.
    pub nominal: f64,
    /// Of the corrected model.
    pub corrected: f64,
}

impl FreshGaps {
    /// How far the corrected model closes the fresh gap to the `floor` that the truth leaves; `None` if there is none to close.
    pub(super) fn shrink(self, floor: f64) -> Option<f64> {
        let open = self.nominal - floor;
        (open > 0.0).then(|| (self.nominal - self.corrected) / open)
    }
}

/// Gaps on recordings that the diagnosis did not see; `None` where they say nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gaps {
    /// On a fresh one of the same kind.
    pub fresh: Option<FreshGaps>,
    /// On one with another excitation, amplitude and load.
    pub transfer: Option<FreshGaps>,
}

/// What became of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of the case.
    pub case: u64,
    /// Its kind; a single effect that was withheld from the diagnosis counts as outside the vocabulary.
    pub kind: Kind,
    /// What was hidden.
    pub truth: Vec<String>,
    /// The first name, or the verdict where nothing is named, or `failed`.
    pub answer: String,
    /// Confidence of every name and whether it is right.
    pub confidences: Vec<(f64, bool)>,
    /// Whether the first name is one of the truth.
    pub first: bool,
    /// Whether the truth is among all names and their classes.
    pub in_class: bool,
    /// Whether every effect of the truth is named itself.
    pub all_named: bool,
    /// How many different names were given, classes included.
    pub names: usize,
    /// Whether the answer is what it should be for this kind of case.
    pub right: bool,
    /// Whether `where` hits; `None` if the truth acts in no place.
    pub place: Option<bool>,
    /// Claimed shrink less the shrink on the fresh recording.
    pub claim_error: Option<f64>,
    /// Shrink over that of the true model with its hidden states known.
    pub relative_shrink: Option<f64>,
    /// Time of the diagnosis, s.
    pub elapsed_s: Option<f64>,
    /// Of a messy case: whether the dominant cause has a name.
    #[serde(skip)]
    pub nameable: bool,
    /// Of a messy case: names with a confidence of 0.7 or more.
    #[serde(skip_serializing_if = "is_zero")]
    pub sure_names: usize,
    /// Of a messy case: those among them that are not there.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_there: Vec<String>,
    /// Of a messy case: nothing is named and no number moved.
    #[serde(skip)]
    pub silent: bool,
    /// What the fresh recording says of the claims on a messy case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fresh: Option<Kept>,
    /// What is kept with another excitation, amplitude and load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transfer: Option<Kept>,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Judges `diagnosis` (`None`: it failed) with the effect called `withheld` out of its library.
pub fn judge(
    truth: &Truth,
    diagnosis: Option<&Diagnosis>,
    gaps: Gaps,
    withheld: Option<&str>,
) -> Outcome {
    let kind = match truth.kind {
        Kind::Single
            if truth
                .effects
                .iter()
                .any(|e| Some(e.name.as_str()) == withheld) =>
        {
            Kind::Outside
        }
        kind => kind,
    };
    // A cause outside the vocabulary has no name that could be right.
    let nameable: Vec<&str> = match kind {
        Kind::Outside => Vec::new(),
        Kind::Messy => messy::there(truth, withheld),
        _ => truth
            .effects
            .iter()
            .map(|e| e.name.as_str())
            .filter(|n| Some(*n) != withheld)
            .collect(),
    };
    let mut outcome = Outcome {
        case: truth.case,
        kind,
        truth: truth
            .effects
            .iter()
            .map(|effect| effect.name.clone())
            .collect(),
        answer: "failed".into(),
        confidences: Vec::new(),
        first: false,
        in_class: false,
        all_named: false,
        names: 0,
        right: false,
        place: places(truth).next().map(|_| false),
        claim_error: None,
        relative_shrink: None,
        elapsed_s: None,
        nameable: true,
        sure_names: 0,
        not_there: Vec::new(),
        silent: false,
        fresh: None,
        transfer: None,
    };
    let Some(diagnosis) = diagnosis else {
        return outcome;
    };
    let named: Vec<&str> = diagnosis
        .effects
        .iter()
        .map(|found| found.name.as_str())
        .collect();
    let mut all: Vec<&str> = diagnosis
        .effects
        .iter()
        .flat_map(|found| found.not_separable_from.iter().map(String::as_str))
        .chain(named.iter().copied())
        .collect();
    all.sort_unstable();
    all.dedup();
    outcome.answer = named
        .first()
        .copied()
        .unwrap_or(diagnosis.verdict.name())
        .into();
    outcome.confidences = diagnosis
        .effects
        .iter()
        .map(|found| (found.confidence, nameable.contains(&found.name.as_str())))
        .collect();
    outcome.first = named.first().is_some_and(|name| nameable.contains(name));
    outcome.in_class = !nameable.is_empty() && nameable.iter().all(|name| all.contains(name));
    outcome.all_named = !nameable.is_empty() && nameable.iter().all(|name| named.contains(name));
    outcome.names = all.len();
    let confidently_wrong = outcome
        .confidences
        .iter()
        .any(|(confidence, right)| *confidence >= CONFIDENT && !right);
    outcome.right = match kind {
        Kind::Single => outcome.first,
        Kind::Pair => outcome.all_named,
        Kind::Nothing => diagnosis.verdict == Verdict::NoGap,
        Kind::Outside => match diagnosis.verdict {
            Verdict::Unexplained => true,
            Verdict::PartlyExplained => !confidently_wrong,
            Verdict::NoGap | Verdict::Explained => false,
        },
        Kind::Messy => false,
    };
    if kind == Kind::Messy {
        messy::judge(&mut outcome, truth, diagnosis, withheld);
    }
    if outcome.place.is_some() {
        outcome.place = Some(
            diagnosis
                .regions
                .iter()
                .take(REGIONS)
                .any(|region| places(truth).any(|place| hits(region, place))),
        );
    }
    if matches!(kind, Kind::Single | Kind::Pair | Kind::Messy) {
        let claimed = diagnosis.gap.shrink;
        let kept = |gaps: Option<FreshGaps>, floor: Option<f64>| {
            let (gaps, floor) = gaps.zip(floor)?;
            Kept::of(&diagnosis.gap, gaps, floor)
        };
        let fresh = kept(gaps.fresh, truth.fresh_floor);
        outcome.claim_error = claimed
            .zip(fresh)
            .map(|(claimed, fresh)| claimed - fresh.shrink);
        outcome.fresh = fresh.filter(|_| kind == Kind::Messy);
        outcome.transfer = kept(gaps.transfer, truth.transfer_floor);
        let reachable = diagnosis.gap.before - truth.reference.after;
        let after = diagnosis.gap.after.unwrap_or(diagnosis.gap.before);
        outcome.relative_shrink =
            (reachable > 0.0).then(|| (diagnosis.gap.before - after) / reachable);
    }
    outcome.elapsed_s = Some(diagnosis.elapsed_s);
    outcome
}

/// Where what is hidden acts; of a messy case, where the dominant cause acts.
fn places(truth: &Truth) -> impl Iterator<Item = &Place> {
    let shown = match truth.kind {
        Kind::Messy => 1,
        _ => truth.effects.len(),
    };
    let effects = truth.effects.iter().take(shown);
    effects.flat_map(|effect| &effect.places)
}

/// Whether a region lies on the axis of a place and overlaps it.
fn hits(region: &Region, place: &Place) -> bool {
    if region.axis != place.axis {
        return false;
    }
    let same_run = match (run_index(region), place.run) {
        (Some(found), Some(wanted)) => found == wanted,
        _ => true,
    };
    match place.axis.as_str() {
        "channel" => {
            region.name.as_ref().and_then(serde_json::Value::as_str) == place.name.as_deref()
        }
        "run" => run_index(region).is_some() && same_run,
        _ => match (region.from, region.to, place.from, place.to) {
            (Some(from), Some(to), Some(low), Some(high)) => same_run && from <= high && to >= low,
            _ => false,
        },
    }
}

/// The run that a region names: by index, or by the file `run-3.csv` that the check itself gave it.
fn run_index(region: &Region) -> Option<usize> {
    [&region.run, &region.name]
        .into_iter()
        .flatten()
        .find_map(|value| match value {
            serde_json::Value::Number(index) => {
                index.as_u64().and_then(|index| usize::try_from(index).ok())
            }
            serde_json::Value::String(file) => {
                let number = file.strip_prefix("run-")?.strip_suffix(".csv")?;
                number.parse::<usize>().ok()?.checked_sub(1)
            }
            _ => None,
        })
}
