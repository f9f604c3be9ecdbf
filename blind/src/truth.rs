//! The truth about a recording. It is opened after the diagnosis is made.

use serde::{Deserialize, Serialize};

/// An interval of an axis in which an effect acts. A diagnosis that names an overlapping interval is right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// The axis as the diagnosis names it: `position`, `velocity`, `time`, `channel`, …
    pub axis: String,
    /// Lower end, in the recording's units; `None` for `channel` and `run`.
    #[serde(default)]
    pub from: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub to: Option<f64>,
    /// Index of the run, if the effect acts in one run only.
    #[serde(default)]
    pub run: Option<usize>,
    /// Name of the channel.
    #[serde(default)]
    pub name: Option<String>,
}

impl Place {
    /// The interval from `from` to `to` on `axis`, in every run.
    pub fn on(axis: &str, from: f64, to: f64) -> Self {
        Self {
            axis: axis.into(),
            from: Some(from),
            to: Some(to),
            run: None,
            name: None,
        }
    }

    /// The interval from `from_s` to `to_s` in the time of `run`.
    pub fn in_run(run: usize, from_s: f64, to_s: f64) -> Self {
        Self {
            run: Some(run),
            ..Self::on("time", from_s, to_s)
        }
    }

    /// The whole of `run`.
    pub fn whole_run(run: usize) -> Self {
        Self {
            axis: "run".into(),
            from: None,
            to: None,
            run: Some(run),
            name: None,
        }
    }

    /// A channel of the vocabulary.
    pub fn channel(name: &str) -> Self {
        Self {
            axis: "channel".into(),
            from: None,
            to: None,
            run: None,
            name: Some(name.into()),
        }
    }
}

/// One hidden cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// A name of the vocabulary, or the name of a cause outside it.
    pub name: String,
    /// Its strength in the measure of the generator, for information.
    pub strength: f64,
    /// Its form in words, for information.
    pub form: String,
    /// Places in which it acts. Empty if it acts everywhere.
    pub places: Vec<Place>,
    /// In a messy case: rms change of the prediction by this cause over that by the dominant cause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// The kind of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// One effect of the vocabulary.
    Single,
    /// Two effects of the vocabulary.
    Pair,
    /// The model is right within noise and the stated tolerances.
    Nothing,
    /// A cause outside the vocabulary.
    Outside,
    /// One dominant cause, several small causes, wrong stated numbers and timing errors.
    Messy,
}

/// Gaps that need the truth, in units of position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Gap of the nominal model.
    pub before: f64,
    /// Gap of the true model with known hidden states at every restart.
    pub after: f64,
    /// Gap of the model with the true numbers and without the hidden causes.
    pub hidden_alone: f64,
    /// Rms difference between the nominal model and the model with the true numbers, both without the hidden causes.
    pub tolerances_alone: f64,
}

/// The timing errors of a messy recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The input column is ahead of the position column by this many rows.
    pub offset_rows: f64,
    /// If true, the input column holds values sampled at an instant. The manifest does not say so.
    pub point_sampled: bool,
    /// Standard deviation of the errors of the logged times, in rows.
    pub stamp_std_rows: f64,
    /// Rms change of the prediction by the timing errors over that by the dominant cause.
    pub share: f64,
}

/// The truth of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Seed of the set.
    pub seed: u64,
    /// Number of the case, from 1.
    pub case: u64,
    /// The kind of the case.
    pub kind: Kind,
    /// The device, for information.
    pub device: String,
    /// The hidden causes, largest contribution first. In a messy case they include the wrong stated numbers, each under the
    /// name of the effect that its error equals.
    pub effects: Vec<Effect>,
    /// Reference gaps of the true model.
    pub reference: Reference,
    /// Gap of the true model with known hidden states on the fresh recording, in units of position. `None` if the fresh
    /// recording does not show the hidden cause well enough to judge a claim.
    pub fresh_floor: Option<f64>,
    /// The same gap on the recording with another excitation, amplitude and load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transfer_floor: Option<f64>,
    /// The timing errors of a messy case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
}
