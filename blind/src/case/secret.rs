//! A hidden cause, within or outside the vocabulary.

use crate::reality::Reality;
use crate::scenario::{Cause, Hidden, HiddenOwn, Scale};
use crate::truth::Effect;

/// Least strength of a small cause over the least strength of a cause that acts alone.
const WEAKEST: f64 = 0.02;
/// The same ratio for causes that become stiffer with smaller strength. The time steps must still resolve them.
const STIFF_WEAKEST: f64 = 0.3;

/// An effect of the vocabulary, a cause outside it, or an effect of the user.
#[derive(Clone, Debug)]
pub(super) enum Secret {
    Known(Hidden),
    Foreign(Cause),
    Own(HiddenOwn),
}

impl Secret {
    pub(super) fn apply(&self, reality: &mut Reality, scale: &Scale) {
        match self {
            Self::Known(hidden) => hidden.apply(reality, scale),
            Self::Foreign(cause) => cause.apply(reality, scale),
            Self::Own(own) => own.apply(reality),
        }
    }

    /// Multiplies the strength by `factor`, limited to its range. Returns `false` if it does not change.
    pub(super) fn scale_by(&mut self, factor: f64) -> bool {
        let (strength, [low, high]) = match self {
            Self::Known(hidden) => (&mut hidden.strength, hidden.range),
            Self::Foreign(cause) => (&mut cause.strength, cause.range),
            Self::Own(own) => (&mut own.strength, own.range),
        };
        let before = *strength;
        *strength = (*strength * factor).clamp(low, high);
        (*strength / before - 1.0).abs() > 0.01
    }

    /// Extends the range to lower strengths and sets the strength to the former lower end.
    pub(super) fn weaken(&mut self) {
        let weakest = match self.name() {
            "compliance" | "presliding" | "backlash" => STIFF_WEAKEST,
            _ => WEAKEST,
        };
        let (strength, range) = match self {
            Self::Known(hidden) => (&mut hidden.strength, &mut hidden.range),
            Self::Foreign(cause) => (&mut cause.strength, &mut cause.range),
            Self::Own(own) => (&mut own.strength, &mut own.range),
        };
        *strength = range[0];
        range[0] *= weakest;
    }

    /// The name of the cause.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Known(hidden) => hidden.name,
            Self::Foreign(cause) => cause.name,
            Self::Own(own) => own.name(),
        }
    }

    pub(super) fn describe(&self, scale: &Scale) -> Effect {
        let (name, strength, places, form) = match self {
            Self::Known(hidden) => (
                hidden.name,
                hidden.strength,
                hidden.places(scale),
                format!("{hidden:?}"),
            ),
            Self::Foreign(cause) => (
                cause.name,
                cause.strength,
                cause.places(scale),
                format!("{cause:?}"),
            ),
            // It acts everywhere, so no place is wrong.
            Self::Own(own) => (own.name(), own.strength, Vec::new(), format!("{own:?}")),
        };
        Effect {
            name: name.into(),
            strength,
            form,
            places,
            share: None,
        }
    }
}
