//! What a diagnosis says, as far as it is scored: the contract's section 4.

use serde::{Deserialize, Serialize};

/// The verdict as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing beyond noise and the stated tolerances.
    NoGap,
    /// The named effects close the gap.
    Explained,
    /// They are real, and something more is left.
    PartlyExplained,
    /// A gap, and no name for it.
    Unexplained,
}

impl Verdict {
    /// As the contract writes it.
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
    /// Of the nominal model.
    pub before: f64,
    /// Of the corrected model.
    #[serde(default)]
    pub after: Option<f64>,
    /// On held-out data.
    #[serde(default)]
    pub shrink: Option<f64>,
    /// 95 % interval of it.
    #[serde(default)]
    pub shrink_interval: Option<[f64; 2]>,
}

/// One effect found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// A name of the vocabulary.
    pub name: String,
    /// Probability that it is right.
    pub confidence: f64,
    /// Names that the excitation cannot tell from it.
    #[serde(default)]
    pub not_separable_from: Vec<String>,
    /// How far it alone closes the gap.
    #[serde(default)]
    pub shrink: Option<f64>,
}

/// A stated number that had to move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Its name in the model.
    pub name: String,
    /// How far it alone closes the gap.
    #[serde(default)]
    pub shrink: Option<f64>,
}

/// One region that carries more of the gap than its share of samples.
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
    /// In the order of what each contributes.
    #[serde(default)]
    pub effects: Vec<Found>,
    /// In the order of what each closes.
    #[serde(default)]
    pub numbers: Vec<Moved>,
    /// Most guilty first.
    #[serde(default, rename = "where")]
    pub regions: Vec<Region>,
    /// Time that it took.
    #[serde(default)]
    pub elapsed_s: f64,
}
