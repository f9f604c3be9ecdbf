//! The definition of a user's effect in TOML.

use super::error::OwnEffectError;
use super::expression::VARIABLES;
use crate::missing_torque::axis::Axis;
use host_sim::effects::{Parameter, Quantity};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Largest number of parameters of an effect.
pub(super) const MOST_PARAMETERS: usize = 4;

/// The TOML table of an effect.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Definition {
    /// Name of the effect in results.
    pub name: String,
    /// Description of the effect in a sentence.
    pub about: String,
    /// Torque at the joint, N m, as an expression of `x`, `v`, `u`, `t` and the parameters.
    pub torque: String,
    /// The quantity on which the torque mainly depends.
    #[serde(default)]
    pub axis: OwnAxis,
    /// Parameters by name.
    pub parameters: BTreeMap<String, OwnParameter>,
}

/// A parameter of an effect.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OwnParameter {
    /// Lowest and highest typical value. A fit starts between them. If both are positive, the parameter stays positive.
    pub typical: [f64; 2],
    /// The quantity of the parameter, which determines its unit.
    #[serde(default)]
    pub quantity: OwnQuantity,
    /// Meaning of the parameter, for the report.
    #[serde(default)]
    pub about: String,
}

/// The quantity on which the torque mainly depends.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum OwnAxis {
    #[default]
    Velocity,
    Position,
    Input,
    Time,
}

impl From<OwnAxis> for Axis {
    fn from(axis: OwnAxis) -> Self {
        match axis {
            OwnAxis::Velocity => Self::Velocity,
            OwnAxis::Position => Self::Position,
            OwnAxis::Input => Self::Input,
            OwnAxis::Time => Self::Time,
        }
    }
}

/// The quantity of a parameter, which determines its unit.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum OwnQuantity {
    #[default]
    Ratio,
    Angle,
    Time,
    Frequency,
    Input,
    Position,
    Velocity,
    Torque,
    Stiffness,
    Damping,
    Inertia,
}

impl From<OwnQuantity> for Quantity {
    fn from(quantity: OwnQuantity) -> Self {
        match quantity {
            OwnQuantity::Ratio => Self::Ratio,
            OwnQuantity::Angle => Self::Angle,
            OwnQuantity::Time => Self::Time,
            OwnQuantity::Frequency => Self::Frequency,
            OwnQuantity::Input => Self::Input,
            OwnQuantity::Position => Self::Position,
            OwnQuantity::Velocity => Self::Velocity,
            OwnQuantity::Torque => Self::Torque,
            OwnQuantity::Stiffness => Self::Stiffness,
            OwnQuantity::Damping => Self::Damping,
            OwnQuantity::Inertia => Self::Inertia,
        }
    }
}

impl Definition {
    /// Reads a table.
    ///
    /// # Errors [`OwnEffectError`] for the first fault. The expression is not checked here.
    pub(super) fn read(text: &str) -> Result<Self, OwnEffectError> {
        let own: Self = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| {
                1 + text[..span.start.min(text.len())].matches('\n').count()
            });
            OwnEffectError::Toml(format!("line {line}: {}", error.message()))
        })?;
        let count = own.parameters.len();
        if count == 0 || count > MOST_PARAMETERS {
            return Err(OwnEffectError::Count(count));
        }
        for (name, parameter) in &own.parameters {
            let [low, high] = parameter.typical;
            if !(low.is_finite() && high.is_finite() && low < high) {
                return Err(OwnEffectError::Typical(name.clone()));
            }
            if VARIABLES.contains(&name.as_str()) {
                return Err(OwnEffectError::IsVariable(name.clone()));
            }
        }
        Ok(own)
    }

    /// The parameters in the order of their names.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let all = self.parameters.iter();
        all.map(|(name, own)| Parameter {
            name: name.clone().leak(),
            quantity: own.quantity.into(),
            range: own.range(),
            default: own.middle(),
            typical: own.typical,
            about: own.about.clone().leak(),
        })
        .collect()
    }
}

impl OwnParameter {
    /// True if the value stays positive and has a logarithmic coordinate.
    fn is_positive(&self) -> bool {
        self.typical[0] > 0.0
    }

    fn range(&self) -> [f64; 2] {
        let least = if self.is_positive() {
            f64::MIN_POSITIVE
        } else {
            f64::NEG_INFINITY
        };
        [least, f64::INFINITY]
    }

    fn middle(&self) -> f64 {
        let [low, high] = self.typical;
        if self.is_positive() {
            (low * high).sqrt()
        } else {
            0.5 * (low + high)
        }
    }
}
