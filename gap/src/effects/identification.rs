//! The interface of an effect: how it is identified, with which effects it is confused, and how it is described.

use super::description::Demonstration;
use super::episode::Episode;
use crate::columns::Disagreement;
use crate::guess::Evidence;
use crate::guess::balance::Balance;
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::series::Series;
use host_sim::device::Device;
use host_sim::effects::Kind;
use recording::{Model, Recording};
use std::fmt::Debug;

use super::phrase::{Found, Phrase};

/// A main parameter of the model of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MainNumber {
    /// Name of the parameter in the model.
    pub name: &'static str,
    /// Relative standard deviation of the parameter if no tolerance is stated. It is `None` for a parameter that only scales the others.
    pub usual_error: Option<f64>,
}

/// How one effect is identified from a recording. Each effect implements this trait in its own file. A default implementation means that
/// nothing specific is known.
pub(crate) trait Identification: Debug + Sync {
    /// Equation, parameters, bounds and typical values.
    fn kind(&self) -> &'static Kind;

    /// Starts of the fit. Returns none if the recording cannot show the effect.
    fn starts(&self, evidence: &Evidence<'_>) -> Vec<Term>;

    /// Shape parameters that may be freed after the first fit, for a motion of ± `half_span`.
    fn further_shape(&self, _fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        Vec::new()
    }

    /// Terms with one part more than the fitted one, for example another wave of a ripple. `_beyond` is the evidence without the fitted
    /// effect.
    fn with_another_part(&self, _fitted: &Term, _beyond: &Evidence<'_>) -> Vec<Term> {
        Vec::new()
    }

    /// The effect with fewer free parameters, each with its coordinates. It starts from the fit at `x`, for positions between two
    /// `extremes`.
    fn reduced_forms(
        &self,
        _fitted: &Term,
        _x: &[f64],
        _model: &Model,
        _extremes: [f64; 2],
    ) -> Vec<(Term, Vec<f64>)> {
        Vec::new()
    }

    /// Index and value of a parameter that keeps the stated value of the model unless another value fits better.
    fn stated_parameter(&self, _model: &Model) -> Option<(usize, f64)> {
        None
    }

    /// The main parameter of the model that the effect estimates anew, if any.
    fn main_number(&self) -> Option<MainNumber> {
        None
    }

    /// The parameter of the model that the effect replaces, if any. If that parameter deviates more than its tolerance, the diagnosis
    /// names the effect.
    fn replaces(&self) -> Option<&'static str> {
        self.main_number().map(|number| number.name)
    }

    /// A start of the fit at the value from the balance of torques along the motion.
    fn balanced(&self, own: &Term, _balance: &Balance) -> Term {
        own.clone()
    }

    /// The parameter of the model that the effect sets. The tolerance of that parameter then has no influence.
    fn sets_in_model(&self) -> Option<&'static str> {
        None
    }

    /// How the fit is searched.
    fn landscape(&self) -> Landscape {
        Landscape::Smooth
    }

    /// True if the effect acts in one or two windows only. Its fit then keeps the model parameters and begins from more starts.
    fn is_local(&self) -> bool {
        false
    }

    /// True if the effect is not limited to certain instants, but may still gain in too few windows for cross-validation.
    fn may_show_in_few_windows(&self) -> bool {
        false
    }

    /// The search of the intervals of a temporary effect, or `None` for a permanent one.
    fn episode(&self) -> Option<&dyn Episode> {
        None
    }

    /// True if a device of the recorded type cannot have the effect.
    fn is_impossible(&self, _recording: &Recording) -> bool {
        false
    }

    /// The effects that equal this one for certain values of its parameters.
    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// Simpler effects that are preferred if they explain nearly as much, although they are no special cases.
    fn simpler_substitutes(&self) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// The family of effects with nearly the same action on small, slow motion.
    fn family(&self) -> Option<Family> {
        None
    }

    /// The action of the fitted effect on small motion, which replaces a parameter of `model`.
    fn on_small_motion(&self, _fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        None
    }

    /// A start of the fit at the values with which the effect acts like another one on small motion.
    fn equivalent_start(&self, _own: &Term, _other: SmallMotion, _model: &Model) -> Option<Term> {
        None
    }

    /// Effects that no recording can distinguish from this one at its fitted values.
    fn indistinguishable(&self, _fitted: &Term) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// True if the fit ended at values with which the effect no longer acts as its name says.
    fn is_degenerate(&self, _fit: &Fitted<'_>) -> bool {
        false
    }

    /// Number of spatial periods between the `extremes` of the position, if the effect is periodic and they are too few to show that.
    fn too_few_periods(&self, _fitted: &Term, _extremes: [f64; 2]) -> Option<f64> {
        None
    }

    /// True if the effect is a resonance. Together with a delayed drive or sensor it acts like a drive with its own dynamics.
    fn resonates(&self) -> bool {
        false
    }

    /// True if the effect is only another formula for the Coulomb friction of the model. Two simulations of one device may differ in it.
    fn reformulates_friction(&self) -> bool {
        false
    }

    /// Parameter values with which a sensing effect converts one position column into another, one set for each form.
    fn column_fits(&self, _columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Number of fitted parameters among the values of [`Self::column_fits`].
    fn count_in_columns(&self, values: &[f64]) -> usize {
        values.iter().filter(|value| **value != 0.0).count()
    }

    /// The axis along which the torque of the effect is most visible.
    fn axis(&self) -> Axis;

    /// Possible torques of the effect along the motion of `path`, to explain the missing torque `target`. Returns none if the effect
    /// causes no torque there.
    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form>;

    /// The noun for the effect in a sentence, without its parameters.
    fn noun(&self) -> &'static str;

    /// The evidence that distinguishes the effect from similar ones, and a recording that shows it. It is empty if not known.
    fn tell_apart(&self) -> &'static str {
        ""
    }

    /// The experiment that demonstrates the effect in the documentation.
    fn demonstration(&self) -> Demonstration {
        Demonstration::USUAL
    }

    /// The part of a sentence that describes a finding. Each `{parameter}` is replaced by its value.
    fn template(&self, found: &Found<'_>) -> &'static str;

    /// The description of a finding with its numbers.
    fn phrase(&self, found: &Found<'_>) -> Phrase {
        self.filled_template(found)
    }

    /// The template with its values, or the noun if one of them was not found.
    fn filled_template(&self, found: &Found<'_>) -> Phrase {
        let filled = found.filled(self.template(found));
        filled.unwrap_or_else(|| Phrase::of(self.noun()))
    }
}

impl dyn Identification {
    /// Name of the effect in the vocabulary.
    pub(crate) fn name(&self) -> &'static str {
        self.kind().name
    }

    /// True if this effect equals the effect `special` for certain values of its parameters.
    pub(crate) fn contains(&self, special: &str) -> bool {
        let mut cases = self.special_cases().iter();
        cases.any(|case| case.name() == special)
    }

    /// True if the effect `special` explains nearly the same with fewer parameters.
    pub(crate) fn gives_way_to(&self, special: &str) -> bool {
        let mut substitutes = self.simpler_substitutes().iter();
        self.contains(special) || substitutes.any(|simpler| simpler.name() == special)
    }
}

/// The shape of the cost over the free parameters of an effect. It decides how the fit is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Landscape {
    /// Gradients lead to the optimum from the starts with the lowest linear cost.
    Smooth,
    /// The effect acts through a hidden state, so the linear cost of a start says nothing.
    Hysteretic,
    /// The cost has many optima. The lowest points of a scan are fitted.
    Resonant,
    /// The cost has many optima and no useful slopes because of impacts. A scan is followed by an evolution strategy.
    Rugged,
}

impl Landscape {
    /// True if a scan over many values precedes the fits.
    pub(crate) fn is_scanned(self) -> bool {
        matches!(self, Self::Resonant | Self::Rugged)
    }
}

/// Families of effects that cannot be distinguished on small, slow motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// A torque in one direction.
    Push,
    /// A resistance that increases with speed.
    Drag,
    /// A torque towards one position.
    Restoring,
    /// A delayed motion.
    Lateness,
    /// A motion with a different amplitude.
    Size,
}

/// The action of an effect on small motion, in the terms of its family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SmallMotion {
    /// Torque in one direction, N m.
    Push { torque_nm: f64 },
    /// Slope of a restoring torque and the position at which it is zero, as fitted and as stated.
    Restoring { fitted: [f64; 2], stated: [f64; 2] },
    /// Delay of a reading, s.
    LateReading { time_s: f64 },
    /// Amplitude of the motion over that of the model.
    Size { ratio: f64 },
}

/// A fit whose last effect is checked for degeneracy.
pub(crate) struct Fitted<'a> {
    /// The effect as fitted.
    pub term: &'a Term,
    /// The device with all effects.
    pub device: &'a Device,
    pub series: &'a [Series],
    /// Duration of a prediction, s.
    pub horizon_s: f64,
    /// Step of the position sensor, in the unit of the positions; 0 if it is continuous.
    pub resolution: f64,
}
