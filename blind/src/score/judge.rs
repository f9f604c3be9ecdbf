//! Scores one diagnosis against its truth.

use serde::Serialize;

use super::messy;
use super::transfer::Kept;
use crate::diagnosis::{Diagnosis, Region, Verdict};
use crate::truth::{Kind, Place, Truth};

/// A name with at least this confidence counts as confident.
pub(super) const CONFIDENT: f64 = 0.9;
/// Number of regions of `where` that are scored.
const REGIONS: usize = 3;

/// Gaps on the fresh recording, in units of position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreshGaps {
    /// Gap of the nominal model.
    pub nominal: f64,
    /// Gap of the corrected model.
    pub corrected: f64,
}

impl FreshGaps {
    /// Shrink of the fresh gap by the corrected model. 1 = down to `floor`, the gap of the true model. `None` if the nominal
    /// gap is not above the floor.
    pub(super) fn shrink(self, floor: f64) -> Option<f64> {
        let open = self.nominal - floor;
        (open > 0.0).then(|| (self.nominal - self.corrected) / open)
    }
}

/// Gaps on recordings that the diagnosis did not read. `None` where nothing was measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gaps {
    /// On a fresh recording with the same kind of excitation.
    pub fresh: Option<FreshGaps>,
    /// On a recording with another excitation, amplitude and load.
    pub transfer: Option<FreshGaps>,
}

/// The score of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of the case.
    pub case: u64,
    /// The kind of the case. A single effect that is withheld from the diagnosis counts as outside the vocabulary.
    pub kind: Kind,
    /// Names of the hidden causes.
    pub truth: Vec<String>,
    /// The first name. Without a name it is the verdict, and `failed` if the diagnosis failed.
    pub answer: String,
    /// The confidence of every name, and whether the name is right.
    pub confidences: Vec<(f64, bool)>,
    /// Whether the first name is one of the hidden causes.
    pub first: bool,
    /// Whether the truth is among all names and the names not separable from them.
    pub in_class: bool,
    /// Whether every hidden effect is named itself.
    pub all_named: bool,
    /// Number of different names, including those not separable.
    pub names: usize,
    /// Whether the answer is right for this kind of case.
    pub right: bool,
    /// Whether `where` names a place in which the truth acts. `None` if it acts everywhere.
    pub place: Option<bool>,
    /// Claimed shrink less the shrink on the fresh recording.
    pub claim_error: Option<f64>,
    /// Shrink over that of the true model with known hidden states.
    pub relative_shrink: Option<f64>,
    /// Time of the diagnosis, s.
    pub elapsed_s: Option<f64>,
    /// In a messy case: whether the vocabulary contains the dominant cause.
    #[serde(skip)]
    pub nameable: bool,
    /// In a messy case: number of names with a confidence of 0.7 or more.
    #[serde(skip_serializing_if = "is_zero")]
    pub sure_names: usize,
    /// In a messy case: those of these names that are not among the hidden causes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_there: Vec<String>,
    /// In a messy case: whether no effect is named and no number is changed.
    #[serde(skip)]
    pub silent: bool,
    /// In a messy case: the claims compared with the fresh recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fresh: Option<Kept>,
    /// The claims compared with a recording of another excitation, amplitude and load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transfer: Option<Kept>,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Scores `diagnosis`, or `None` if it failed. `withheld` is the effect that was removed from its library.
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
    // For a cause outside the vocabulary, no name is right.
    let nameable: Vec<&str> = match kind {
        Kind::Outside => Vec::new(),
        Kind::Messy => messy::present(truth, withheld),
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

/// Places in which the hidden causes act. In a messy case only the dominant cause counts.
fn places(truth: &Truth) -> impl Iterator<Item = &Place> {
    let shown = match truth.kind {
        Kind::Messy => 1,
        _ => truth.effects.len(),
    };
    let effects = truth.effects.iter().take(shown);
    effects.flat_map(|effect| &effect.places)
}

/// Returns true if the region and the place have the same axis and overlap.
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

/// The run that a region names, by index or by the file name `run-3.csv` that the check gave it.
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
