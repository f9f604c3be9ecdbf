//! What was hidden in a recording: opened after the diagnosis is made.

use serde::{Deserialize, Serialize};

/// A stretch of an axis on which an effect acts; finding it there is right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// As in the diagnosis: `position`, `velocity`, `time`, `channel`, …
    pub axis: String,
    /// Lower end, in the recording's units; `None` for `channel` and `run`.
    #[serde(default)]
    pub from: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub to: Option<f64>,
    /// Index of the only run in which it acts.
    #[serde(default)]
    pub run: Option<usize>,
    /// Name of the channel.
    #[serde(default)]
    pub name: Option<String>,
}

impl Place {
    /// From `from` to `to` on `axis`, in every run.
    pub fn on(axis: &str, from: f64, to: f64) -> Self {
        Self {
            axis: axis.into(),
            from: Some(from),
            to: Some(to),
            run: None,
            name: None,
        }
    }

    /// From `from_s` to `to_s` in the time of `run`.
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

/// One thing that was hidden.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// A name of the vocabulary, or the name of a cause outside it.
    pub name: String,
    /// Its strength in the generator's own measure, for people.
    pub strength: f64,
    /// Its form, for people.
    pub form: String,
    /// Where it acts; empty if in no place more than in others.
    pub places: Vec<Place>,
    /// In a messy case: the rms change of the prediction that it causes, over the one that the dominant cause causes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// What kind of case it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// One effect of the vocabulary.
    Single,
    /// Two effects of the vocabulary.
    Pair,
    /// Nothing beyond noise and the stated tolerances.
    Nothing,
    /// A cause that the vocabulary has no name for.
    Outside,
    /// One dominant cause, with several small ones, wrong numbers and bad timing beside it.
    Messy,
}

/// Gaps that only somebody who knows the truth can measure, in units of position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Of the nominal model.
    pub before: f64,
    /// Of the true model with its hidden states known at every restart.
    pub after: f64,
    /// Of the true numbers without what is hidden.
    pub hidden_alone: f64,
    /// Between the nominal model and the true numbers without what is hidden.
    pub tolerances_alone: f64,
}

/// What is wrong with the times of a messy recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The input column is ahead of the position column by this many rows.
    pub offset_rows: f64,
    /// The input column is the value at an instant; the manifest does not say so.
    pub point_sampled: bool,
    /// Standard deviation of the errors of the logged times, in rows.
    pub stamp_std_rows: f64,
    /// The rms change of the prediction that all of this causes, over the one that the dominant cause causes.
    pub share: f64,
}

/// The truth of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Seed of the set.
    pub seed: u64,
    /// Number of the case, from 1.
    pub case: u64,
    /// What kind of case it is.
    pub kind: Kind,
    /// The device, for people.
    pub device: String,
    /// What was hidden, the one that contributes most first. In a messy case stated numbers that are off stand among them,
    /// each under the name of its effect.
    pub effects: Vec<Effect>,
    /// What the truth itself reaches.
    pub reference: Reference,
    /// Gap of the true model on the fresh recording, with its hidden states known, in units of position; `None` where that
    /// recording does not show what is hidden well enough to judge a claim on it.
    pub fresh_floor: Option<f64>,
    /// The same for the recording with another excitation, amplitude and load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transfer_floor: Option<f64>,
    /// Of a messy case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
}
