//! The parts of a diagnosis that are scored. They follow section 4 of the contract.

use serde::{Deserialize, Serialize};

/// The overall verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The gap is within noise and the stated tolerances.
    NoGap,
    /// The named effects close the gap.
    Explained,
    /// The named effects are significant, but part of the gap remains.
    PartlyExplained,
    /// There is a gap, and no effect is named.
    Unexplained,
}

impl Verdict {
    /// The verdict as the contract writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no_gap",
            Self::Explained => "explained",
            Self::PartlyExplained => "partly_explained",
            Self::Unexplained => "unexplained",
        }
    }
}

/// Gaps in units of position, and the shrink.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Gap of the nominal model.
    pub before: f64,
    /// Gap of the corrected model.
    #[serde(default)]
    pub after: Option<f64>,
    /// Shrink on held-out data. 1 = the gap is closed to the floor.
    #[serde(default)]
    pub shrink: Option<f64>,
    /// 95 % interval of the shrink.
    #[serde(default)]
    pub shrink_interval: Option<[f64; 2]>,
}

/// One effect that the diagnosis names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// A name of the vocabulary.
    pub name: String,
    /// Probability that the name is right.
    pub confidence: f64,
    /// Names that this excitation cannot separate from it.
    #[serde(default)]
    pub not_separable_from: Vec<String>,
    /// Shrink of the gap by this effect alone.
    #[serde(default)]
    pub shrink: Option<f64>,
}

/// A stated number that the diagnosis changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// The name of the number in the model.
    pub name: String,
    /// Shrink of the gap by this change alone.
    #[serde(default)]
    pub shrink: Option<f64>,
}

/// A region that contributes more to the gap than its share of the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// `velocity`, `position`, `time`, …
    pub axis: String,
    /// Lower end.
    #[serde(default)]
    pub from: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub to: Option<f64>,
    /// Index or file of the run.
    #[serde(default)]
    pub run: Option<serde_json::Value>,
    /// Name of the channel or run.
    #[serde(default)]
    pub name: Option<serde_json::Value>,
}

/// The diagnosis of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// The verdict.
    pub verdict: Verdict,
    /// The gap before and after.
    pub gap: Gap,
    /// The named effects, in the order of their contribution.
    #[serde(default)]
    pub effects: Vec<Found>,
    /// The changed numbers, in the order of their contribution.
    #[serde(default)]
    pub numbers: Vec<Moved>,
    /// The regions, largest contribution first.
    #[serde(default, rename = "where")]
    pub regions: Vec<Region>,
    /// Time of the diagnosis, s.
    #[serde(default)]
    pub elapsed_s: f64,
}
