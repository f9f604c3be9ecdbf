//! What a diagnosis says, in the form of the recording format.

use indexmap::IndexMap;
use serde::Serialize;
use std::collections::BTreeMap;

/// Whether there is a gap, and whether it is understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing beyond noise and the stated tolerances.
    NoGap,
    /// The named effects leave at most 15 % of the excess.
    Explained,
    /// The named effects are real and something more is left, or another cause would do the same.
    PartlyExplained,
    /// A gap, and no effect earns its place.
    Unexplained,
}

/// The model that a floor belongs to: how much noise and restarts leave depends on the motion that they disturb.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorOf {
    /// The model as the diagnosis corrects it.
    CorrectedModel,
    /// The model as stated, where what was found leaves no less than it, or where nothing was found.
    NominalModel,
}

/// Gap before and after, on data that the fit has not seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Closing {
    /// Of the nominal model, in units of position.
    pub before: f64,
    /// What noise, quantising and restarts alone would leave, in units of position, if the model that `floor_of` names were
    /// right.
    pub floor: f64,
    /// Whose motion the floor was made with.
    pub floor_of: FloorOf,
    /// The same floor if the nominal model were right, as [`crate::measure`] gives it.
    pub nominal_floor: f64,
    /// Of the corrected model, in units of position.
    pub after: f64,
    /// Of a predictor that knows no model: the position stays where it was at the restart.
    pub standing: f64,
    /// Of another one: the position goes on at the restart's velocity.
    pub coasting: f64,
    /// `(before − after) / (before − floor)`.
    pub shrink: f64,
    /// 95 % interval of it on another recording of the device.
    pub shrink_interval: [f64; 2],
    /// Of position.
    pub unit: String,
}

/// Largest share of the excess that may be left for a gap to count as explained.
const EXPLAINED: f64 = 0.15;

impl Closing {
    /// True if hardly any of what a model could undercut is left: `√(after² − floor²)` is at most 15 % of what it was before.
    pub fn is_closed(&self) -> bool {
        let excess = |gap: f64| (gap * gap - self.floor * self.floor).max(0.0).sqrt();
        excess(self.after) <= EXPLAINED * excess(self.before)
    }
}

/// A fitted number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// In `unit`.
    pub value: f64,
    /// Standard deviation, in `unit`; `None` where it is not known: for a number that was not fitted, and for one whose fit
    /// ended where it may have stalled.
    pub std: Option<f64>,
    /// Unit of `stated`, `found` and `std`.
    pub unit: String,
    /// True if the data moved it.
    #[serde(skip)]
    pub is_fitted: bool,
}

/// A number of the model that had to move, or that is not stated and was estimated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumberFinding {
    /// Its name in `[model]`.
    pub name: String,
    /// As the recording states it, in `unit`; `None` where it does not.
    pub stated: Option<f64>,
    /// As fitted, in `unit`.
    pub found: f64,
    /// Standard deviation of `found`, in `unit`; `None` where it is not known.
    pub std: Option<f64>,
    /// Distance from what is stated, in stated standard deviations; `None` where nothing is stated.
    pub sigmas: Option<f64>,
    /// Share of the gap that its move closes: its Shapley share beside the effects and the other numbers.
    pub shrink: f64,
    /// 95 % interval of it on another recording of the device.
    pub shrink_interval: [f64; 2],
    /// Unit of `stated`, `found` and `std`.
    pub unit: String,
}

/// An effect that earned its place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// In the vocabulary.
    pub name: &'static str,
    /// In the vocabulary.
    pub channel: &'static str,
    /// Probability that it is the true one.
    pub confidence: f64,
    /// Names that this excitation cannot tell from it.
    pub not_separable_from: Vec<&'static str>,
    /// What its shrink rests on: `prediction` or `sensor_comparison`.
    pub basis: &'static str,
    /// False where it shows in too few windows for any to be held out: its shrink is on data that the fit has seen, as a warning
    /// says.
    #[serde(skip)]
    pub held_out: bool,
    /// By name, in the order of the effect's definition.
    pub parameters: IndexMap<String, Estimate>,
    /// Of this effect alone, on top of those before it.
    pub shrink: f64,
    /// 95 % interval of it on another recording of the device.
    pub shrink_interval: [f64; 2],
}

/// Name of the velocities at a rest or a reversal and right after.
pub const AFTER_REST: &str = "rest and right after";

/// What the gap is measured by where a part of it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasuredBy {
    /// The squared residual of short predictions, beyond noise: where the gap arises.
    ShortPredictions,
    /// The squared residual of predictions over the whole horizon: where the gap has grown largest.
    WholeHorizon,
    /// The square of the torque that the nominal model lacks: where that acts.
    MissingTorque,
    /// The power of the acceleration that short predictions miss, over frequency.
    Spectrum,
    /// How much better a second position sensor is predicted.
    SecondSensor,
}

/// A part of the data that carries clearly more of the gap than its share of the samples: the lower end of its
/// `share_of_gap_interval` is above `share_of_samples`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Region {
    /// `velocity`, `position`, `time`, `input`, `acceleration`, `frequency`, `channel` or `run`.
    pub axis: &'static str,
    /// In the recording's units.
    pub from: Option<f64>,
    /// In the recording's units.
    pub to: Option<f64>,
    /// Of a channel or run; [`AFTER_REST`] for velocities that count because the motion has just been at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Index of the run, where it lies in one.
    pub run: Option<usize>,
    /// What the share of the gap is a share of.
    pub measured_by: MeasuredBy,
    /// From 0 to 1.
    pub share_of_gap: f64,
    /// 95 %.
    pub share_of_gap_interval: [f64; 2],
    /// Of the samples; for a frequency, of the power of motion and input.
    pub share_of_samples: f64,
    /// The same shares all along the axis; `None` for a channel.
    #[serde(skip)]
    pub profile: Option<Profile>,
}

impl Region {
    /// True if the lower end of the interval of its share of the gap is above its share of the samples.
    pub fn is_clear(&self) -> bool {
        self.share_of_gap_interval[0] > self.share_of_samples
    }
}

/// Shares of gap and samples all along an axis: what the regions on it were chosen by.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// What a place on the axis is.
    pub along: &'static str,
    /// In the order of the axis, one beginning where the one before it ends.
    pub parts: Vec<ProfilePart>,
    /// Where on it the region begins and ends: always at an end of a part.
    pub marked: [f64; 2],
}

/// A part of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfilePart {
    /// In the recording's units.
    pub from: f64,
    /// In the recording's units.
    pub to: f64,
    /// File of the run that it is, if it is one.
    pub run: Option<String>,
    /// Share of the gap that lies in it.
    pub share_of_gap: f64,
    /// Share of the samples, as in [`Region::share_of_samples`].
    pub share_of_samples: f64,
}

impl ProfilePart {
    /// Share of the gap over share of the samples, 1 where both are the same; not a number without samples.
    pub fn density(&self) -> f64 {
        self.share_of_gap / self.share_of_samples
    }
}

/// An effect that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// In the vocabulary.
    pub name: &'static str,
    /// Gap that it leaves, in units of position.
    pub after: f64,
    /// Why it was not named.
    pub why_not: String,
}

/// The excitation that would tell rivals apart best.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextExperiment {
    /// An excitation of the firmware.
    pub kind: &'static str,
    /// The names it would separate.
    pub separates: Vec<&'static str>,
    /// Its numbers.
    pub settings: BTreeMap<&'static str, f64>,
    /// Predicted difference of the rivals that no numbers within what this recording says of them make up for, rms, over
    /// noise.
    pub difference_over_noise: f64,
}

/// The whole diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Of this format: 1.
    pub format: u32,
    /// In short.
    pub verdict: Verdict,
    /// How far.
    pub gap: Closing,
    /// Which, in the order of what each contributes.
    pub effects: Vec<Finding>,
    /// Numbers of the model that had to move, in the order of what each closes.
    pub numbers: Vec<NumberFinding>,
    /// Where, the most telling first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// What else was tried.
    pub candidates: Vec<Tried>,
    /// Why nothing is named although something closed the gap; it is among the warnings, too.
    #[serde(skip)]
    pub rejection: Option<String>,
    /// What to record next, if names are left that cannot be told apart.
    pub next_experiment: Option<NextExperiment>,
    /// What was odd and worked around, and what not to rely on.
    pub warnings: Vec<String>,
    /// s.
    pub elapsed_s: f64,
}
