//! The result of a diagnosis, as defined by the recording format.

use indexmap::IndexMap;
use serde::Serialize;
use std::collections::BTreeMap;

/// Whether a gap exists, and whether the findings explain it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No gap beyond noise and the stated tolerances.
    NoGap,
    /// The named effects leave at most 15 % of the excess.
    Explained,
    /// The named effects are real, but a part of the gap remains, or another cause would act equally.
    PartlyExplained,
    /// A gap exists, and no effect is accepted.
    Unexplained,
}

/// The model of a floor. The influence of noise and restarts depends on the motion, and so on the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorOf {
    /// The model with the corrections of the diagnosis.
    CorrectedModel,
    /// The model as stated: if no effect was found, or if the floor of the corrected model is not below the original gap.
    NominalModel,
}

/// Gap before and after the correction, on held-out data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Closing {
    /// Gap of the nominal model, in position units.
    pub before: f64,
    /// Expected rms residual from noise, quantization and restarts if the model of `floor_of` were exact, in position units.
    pub floor: f64,
    /// The model of the floor.
    pub floor_of: FloorOf,
    /// Floor if the nominal model were exact, as in [`crate::measure`], in position units.
    pub nominal_floor: f64,
    /// Gap of the corrected model, in position units.
    pub after: f64,
    /// Gap of a model-free predictor that keeps the position at the restart, in position units.
    pub standing: f64,
    /// Gap of a model-free predictor that keeps the velocity at the restart, in position units.
    pub coasting: f64,
    /// `(before − after) / (before − floor)`.
    pub shrink: f64,
    /// 95 % interval of the shrink on another recording of the device.
    pub shrink_interval: [f64; 2],
    /// Unit of the position.
    pub unit: String,
}

/// Largest share of the excess that may remain for a gap to count as explained.
const EXPLAINED: f64 = 0.15;

impl Closing {
    /// True if `√(after² − floor²)` is at most 15 % of `√(before² − floor²)`.
    pub fn is_closed(&self) -> bool {
        let excess = |gap: f64| (gap * gap - self.floor * self.floor).max(0.0).sqrt();
        excess(self.after) <= EXPLAINED * excess(self.before)
    }
}

/// A parameter value with its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Value, in `unit`.
    pub value: f64,
    /// Standard deviation, in `unit`. It is `None` for a parameter that was not fitted, and for one whose fit may have stalled.
    pub std: Option<f64>,
    /// Unit of `stated`, `found` and `std`.
    pub unit: String,
    /// True if the parameter was fitted.
    #[serde(skip)]
    pub is_fitted: bool,
}

/// A model parameter that moved, or that is not stated and was estimated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumberFinding {
    /// Name in `[model]`.
    pub name: String,
    /// Stated value, in `unit`; `None` if it is not stated.
    pub stated: Option<f64>,
    /// Fitted value, in `unit`.
    pub found: f64,
    /// Standard deviation of `found`, in `unit`; `None` if it is not known.
    pub std: Option<f64>,
    /// Distance from the stated value, in stated standard deviations; `None` without a stated deviation.
    pub sigmas: Option<f64>,
    /// Share of the gap that its change closes: the Shapley share among the effects and the other parameters.
    pub shrink: f64,
    /// 95 % interval of the shrink on another recording of the device.
    pub shrink_interval: [f64; 2],
    /// Unit of `stated`, `found` and `std`.
    pub unit: String,
}

/// An effect that was accepted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// In the vocabulary.
    pub name: &'static str,
    /// In the vocabulary.
    pub channel: &'static str,
    /// Probability that the effect is the true cause.
    pub confidence: f64,
    /// Names of effects that this excitation does not distinguish from it.
    pub not_separable_from: Vec<&'static str>,
    /// Evidence for the shrink: `prediction` or `sensor_comparison`.
    pub basis: &'static str,
    /// False if the effect acts in too few windows for held-out data. The shrink is then on fitted data, as a warning states.
    #[serde(skip)]
    pub held_out: bool,
    /// Parameters by name, in the order of the definition of the effect.
    pub parameters: IndexMap<String, Estimate>,
    /// Shrink by this effect: its part of the total shrink, or for a sensor comparison the shrink of the disagreement.
    pub shrink: f64,
    /// 95 % interval of the shrink on another recording of the device.
    pub shrink_interval: [f64; 2],
}

/// Name of the velocities at standstill or a reversal and shortly after.
pub const AFTER_REST: &str = "rest and right after";

/// The measure of the gap of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasuredBy {
    /// Squared residual of short predictions beyond noise: where the gap arises.
    ShortPredictions,
    /// Squared residual of predictions over the whole horizon: where the gap is largest.
    WholeHorizon,
    /// Squared missing torque of the nominal model: where it acts.
    MissingTorque,
    /// Power of the missing acceleration of short predictions, over frequency.
    Spectrum,
    /// Decrease of the gap if a second position sensor is predicted.
    SecondSensor,
}

/// A part of the data with clearly more of the gap than of the samples: the lower end of its `share_of_gap_interval` is above
/// `share_of_samples`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Region {
    /// `velocity`, `position`, `time`, `input`, `acceleration`, `frequency`, `channel` or `run`.
    pub axis: &'static str,
    /// In the recording's units.
    pub from: Option<f64>,
    /// In the recording's units.
    pub to: Option<f64>,
    /// Name of a channel or run, or [`AFTER_REST`] for velocities at standstill and shortly after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Index of the run, if the region lies in one.
    pub run: Option<usize>,
    /// The measure of the gap.
    pub measured_by: MeasuredBy,
    /// Share of the gap, from 0 to 1.
    pub share_of_gap: f64,
    /// 95 % interval of the share of the gap.
    pub share_of_gap_interval: [f64; 2],
    /// Share of the samples, or for a frequency of the power of motion and input.
    pub share_of_samples: f64,
    /// Shares along the whole axis; `None` for a channel.
    #[serde(skip)]
    pub profile: Option<Profile>,
}

impl Region {
    /// True if the lower end of the interval of the share of the gap is above the share of the samples.
    pub fn is_clear(&self) -> bool {
        self.share_of_gap_interval[0] > self.share_of_samples
    }
}

/// Shares of gap and samples along a whole axis, from which its regions were chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Name of the coordinate on the axis.
    pub along: &'static str,
    /// Parts in the order of the axis, each beginning at the end of the one before.
    pub parts: Vec<ProfilePart>,
    /// Begin and end of the region, each at an edge of a part.
    pub marked: [f64; 2],
}

/// A part of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfilePart {
    /// In the recording's units.
    pub from: f64,
    /// In the recording's units.
    pub to: f64,
    /// File of the run, on the axis of runs.
    pub run: Option<String>,
    /// Share of the gap in the part.
    pub share_of_gap: f64,
    /// Share of the samples, as in [`Region::share_of_samples`].
    pub share_of_samples: f64,
}

impl ProfilePart {
    /// Share of the gap over share of the samples; not a number without samples.
    pub fn density(&self) -> f64 {
        self.share_of_gap / self.share_of_samples
    }
}

/// An effect that was tried and not named.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// In the vocabulary.
    pub name: &'static str,
    /// Gap with the effect, in position units.
    pub after: f64,
    /// The reason why it was not named.
    pub why_not: String,
}

/// The excitation that distinguishes rival effects best.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextExperiment {
    /// Name of an excitation of the firmware.
    pub kind: &'static str,
    /// Names of the effects that it distinguishes.
    pub separates: Vec<&'static str>,
    /// Settings of the excitation.
    pub settings: BTreeMap<&'static str, f64>,
    /// Predicted rms difference of the readings of the rivals over the noise, after the best compensation by their parameters within the
    /// information of this recording.
    pub difference_over_noise: f64,
}

/// The whole diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Version of this format: 1.
    pub format: u32,
    /// The verdict.
    pub verdict: Verdict,
    /// The gap before and after the correction.
    pub gap: Closing,
    /// The accepted effects, in the order of their contribution.
    pub effects: Vec<Finding>,
    /// Model parameters that moved, in the order of their contribution.
    pub numbers: Vec<NumberFinding>,
    /// Regions of the gap, most informative first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// Other effects that were tried.
    pub candidates: Vec<Tried>,
    /// The reason why no effect is named although one closed the gap. It is also among the warnings.
    #[serde(skip)]
    pub rejection: Option<String>,
    /// The next experiment, if the recording does not distinguish some effects.
    pub next_experiment: Option<NextExperiment>,
    /// Unusual properties of the recording that were handled, and results that are uncertain.
    pub warnings: Vec<String>,
    /// Duration of the diagnosis, s.
    pub elapsed_s: f64,
}
