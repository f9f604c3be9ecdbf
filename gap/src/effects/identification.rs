//! What may be known of an effect beside its equation: how it is identified, mistaken and described.

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

/// A number without which the model of an axis is incomplete.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MainNumber {
    /// Its name in the model.
    pub name: &'static str,
    /// Relative standard deviation that it has where no tolerance is stated; `None` for one that only scales the others. Held, and
    /// freed much wider, these numbers cost a fifth of the right first names in a trial on recordings with several small causes.
    pub usual_error: Option<f64>,
}

/// How one effect is identified from a recording. Each effect implements it in a file of its own; a default means that nothing
/// special is known.
pub(crate) trait Identification: Debug + Sync {
    /// Equation, parameters, bounds and typical sizes.
    fn kind(&self) -> &'static Kind;

    /// Points from which its fit may begin; none if the recording cannot show it.
    fn starts(&self, evidence: &Evidence<'_>) -> Vec<Term>;

    /// Further shape parameters that may be freed once it is `fitted`, on a motion that goes `half_span` to either side.
    fn further_shape(&self, _fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        Vec::new()
    }

    /// Terms with one part more than the `fitted` one, such as another wave of a ripple, from the evidence that is left beyond it.
    fn with_another_part(&self, _fitted: &Term, _beyond: &Evidence<'_>) -> Vec<Term> {
        Vec::new()
    }

    /// The same effect with fewer free parameters, each with its coordinates, from where it is `fitted` at `x` on positions
    /// between two `extremes`.
    fn reduced_forms(
        &self,
        _fitted: &Term,
        _x: &[f64],
        _model: &Model,
        _extremes: [f64; 2],
    ) -> Vec<(Term, Vec<f64>)> {
        Vec::new()
    }

    /// A parameter, by its place, that keeps the value which the model states unless another fits better.
    fn stated_parameter(&self, _model: &Model) -> Option<(usize, f64)> {
        None
    }

    /// The main number of the model that it says anew, if it says one.
    fn main_number(&self) -> Option<MainNumber> {
        None
    }

    /// The number of the model that it replaces, if it replaces one: beyond what is stated of that number, the effect is named.
    fn replaces(&self) -> Option<&'static str> {
        self.main_number().map(|number| number.name)
    }

    /// A start of its fit at the number that the balance of torques along the motion gives.
    fn balanced(&self, own: &Term, _balance: &Balance) -> Term {
        own.clone()
    }

    /// The number of the model that it sets, so that the tolerance of that number moves nothing beside it.
    fn sets_in_model(&self) -> Option<&'static str> {
        None
    }

    /// How its fit is searched.
    fn landscape(&self) -> Landscape {
        Landscape::Smooth
    }

    /// True if it acts in a window or two only, so that its fit leaves the model's own numbers where they are and begins from
    /// more starts.
    fn is_local(&self) -> bool {
        false
    }

    /// True if it is not bound to moments, but may still gain in too few windows for any to be held out.
    fn may_show_in_few_windows(&self) -> bool {
        false
    }

    /// How it comes and goes, if it acts between instants of the session that are searched for, once or more often.
    fn episode(&self) -> Option<&dyn Episode> {
        None
    }

    /// True if a device such as the recorded one cannot have it.
    fn is_impossible(&self, _recording: &Recording) -> bool {
        false
    }

    /// The effects that it is for some values of its parameters.
    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// Effects with fewer parameters that are preferred to it where they explain nearly as much, though it is none of them for
    /// any values.
    fn simpler_substitutes(&self) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// Which other effects do nearly the same on small, slow motion.
    fn family(&self) -> Option<Family> {
        None
    }

    /// Its action on small motion, `fitted` in place of a number of `model`.
    fn on_small_motion(&self, _fitted: &Term, _model: &Model) -> Option<SmallMotion> {
        None
    }

    /// A start of its fit at the values with which it acts like another effect on small motion.
    fn begun_from(&self, _own: &Term, _other: SmallMotion, _model: &Model) -> Option<Term> {
        None
    }

    /// Effects that no recording can tell from it with its `fitted` values.
    fn indistinguishable(&self, _fitted: &Term) -> &'static [&'static dyn Identification] {
        &[]
    }

    /// True if its fit has ended at values with which it no longer acts as its name says.
    fn is_degenerate(&self, _fit: &Fitted<'_>) -> bool {
        false
    }

    /// Number of its periods between the `extremes` of the positions, if it repeats over position and they are too few
    /// to show that.
    fn too_few_periods(&self, _fitted: &Term, _extremes: [f64; 2]) -> Option<f64> {
        None
    }

    /// True if it is a resonance: beside a drive or a sensor that is late it acts as a drive with dynamics of its own.
    fn resonates(&self) -> bool {
        false
    }

    /// True if it is only another formula for the model's dry friction. Two simulations of one device may differ in it.
    fn reformulates_friction(&self) -> bool {
        false
    }

    /// Values with which it turns one column of position into another, one set for each form of it; of sensing effects.
    fn column_fits(&self, _columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Number of fitted numbers among such values.
    fn count_in_columns(&self, values: &[f64]) -> usize {
        values.iter().filter(|value| **value != 0.0).count()
    }

    /// The axis along which its torque is seen best.
    fn axis(&self) -> Axis;

    /// Its possible torques along the motion of `path` that may explain the missing torque `target`; none if it makes
    /// no torque there.
    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form>;

    /// The noun for the effect in a sentence, without its parameters.
    fn noun(&self) -> &'static str;

    /// Which evidence separates the effect from those that it is confused with, and which recording shows it; empty if not known.
    fn tell_apart(&self) -> &'static str {
        ""
    }

    /// The experiment that shows it in the documentation.
    fn demonstration(&self) -> Demonstration {
        Demonstration::USUAL
    }

    /// The sentence part that describes a finding. Each `{parameter}` stands for its number.
    fn template(&self, found: &Found<'_>) -> &'static str;

    /// The description of a finding with its numbers.
    fn phrase(&self, found: &Found<'_>) -> Phrase {
        self.filled_template(found)
    }

    /// The template with its numbers, or the noun if one of them was not found.
    fn filled_template(&self, found: &Found<'_>) -> Phrase {
        let filled = found.filled(self.template(found));
        filled.unwrap_or_else(|| Phrase::of(self.noun()))
    }
}

impl dyn Identification {
    /// The name in the vocabulary.
    pub(crate) fn name(&self) -> &'static str {
        self.kind().name
    }

    /// True if it is the effect `special` for some values of its parameters.
    pub(crate) fn contains(&self, special: &str) -> bool {
        let mut cases = self.special_cases().iter();
        cases.any(|case| case.name() == special)
    }

    /// True if the effect `special` does with fewer numbers what this one does, or nearly so.
    pub(crate) fn gives_way_to(&self, special: &str) -> bool {
        let mut substitutes = self.simpler_substitutes().iter();
        self.contains(special) || substitutes.any(|simpler| simpler.name() == special)
    }
}

/// What the cost looks like over the free parameters of an effect, which decides how its fit is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Landscape {
    /// Gradients lead to the optimum from the starts with the largest first-order gain.
    Smooth,
    /// It acts through a hidden state that builds up, so that the first-order gain of a start says nothing.
    Hysteretic,
    /// Many optima: the lowest points of a scan over sizes are fitted.
    Resonant,
    /// Many optima, and impacts leave no slope to follow: a scan, then an evolution strategy.
    Rugged,
}

impl Landscape {
    /// True if a scan over many sizes says where the effect may be.
    pub(crate) fn is_scanned(self) -> bool {
        matches!(self, Self::Resonant | Self::Rugged)
    }
}

/// Effects that cannot be told apart on small, slow motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// A push to one side.
    Push,
    /// A resistance that grows with speed.
    Drag,
    /// A torque towards one position.
    Restoring,
    /// A motion that comes late.
    Lateness,
    /// A motion that is larger or smaller.
    Size,
}

/// What an effect does on small motion, in the terms of its family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SmallMotion {
    /// Torque in one direction, N m.
    Push { torque_nm: f64 },
    /// Slope of a restoring torque and the place where it vanishes, as fitted in place of those that are stated.
    Restoring { fitted: [f64; 2], stated: [f64; 2] },
    /// Time by which a reading comes late, s.
    LateReading { time_s: f64 },
    /// Size of the motion over that of the model's.
    Size { ratio: f64 },
}

/// A fit whose last effect is judged.
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
