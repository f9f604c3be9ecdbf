//! An effect that a user wrote down, to be hidden like those of the vocabulary.

use std::collections::BTreeMap;
use std::sync::Arc;

use formula::Formula;
use serde::Deserialize;

use crate::draw::Draw;
use crate::reality::{OwnTorque, Reality};

/// An effect that a user wrote down: a torque as a formula of motion, input, time and parameters.
#[derive(Clone, Debug)]
pub struct OwnEffect {
    name: String,
    torque: Arc<Formula>,
    parameters: Vec<OwnParameter>,
}

#[derive(Clone, Debug)]
struct OwnParameter {
    name: String,
    typical: [f64; 2],
}

/// Why an effect cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
pub enum OwnEffectError {
    /// The text is not a definition of an effect.
    #[error("{0}")]
    Definition(#[from] toml::de::Error),
    /// The torque is not a formula.
    #[error("`torque` is not a formula: {0}")]
    Formula(String),
    /// An interval of typical values is empty, or there is no parameter.
    #[error("each effect needs a parameter whose `typical` is [low, high] with low below high")]
    Parameters,
}

impl OwnEffect {
    /// Reads the definition of an effect, the TOML that `gap diagnose --effect` reads.
    ///
    /// # Errors
    ///
    /// [`OwnEffectError`].
    pub fn read(text: &str) -> Result<Self, OwnEffectError> {
        #[derive(Deserialize)]
        struct Definition {
            name: String,
            torque: String,
            parameters: BTreeMap<String, Parameter>,
        }
        #[derive(Deserialize)]
        struct Parameter {
            typical: [f64; 2],
        }
        let definition: Definition = toml::from_str(text)?;
        let parameters = definition.parameters.into_iter();
        let parameters: Vec<OwnParameter> = parameters
            .map(|(name, Parameter { typical })| OwnParameter { name, typical })
            .collect();
        if parameters.is_empty() || parameters.iter().any(|p| p.typical[0] >= p.typical[1]) {
            return Err(OwnEffectError::Parameters);
        }
        let formula = Formula::parse(&definition.torque).map_err(OwnEffectError::Formula)?;
        Ok(Self {
            name: definition.name,
            torque: Arc::new(formula),
            parameters,
        })
    }
}

/// An effect of the user with its parameters. Its strength is the first parameter in the order of the alphabet.
#[derive(Clone, Debug)]
pub(crate) struct HiddenOwn {
    effect: OwnEffect,
    pub strength: f64,
    pub range: [f64; 2],
    /// Values of the other parameters.
    others: Vec<f64>,
}

impl HiddenOwn {
    /// Draws the parameters of `effect` from their typical values.
    pub fn draw(draw: &mut Draw, effect: &OwnEffect) -> Self {
        let mut values = effect.parameters.iter().map(|parameter| {
            let [low, high] = parameter.typical;
            if low > 0.0 {
                draw.log_uniform(low, high)
            } else {
                draw.uniform(low, high)
            }
        });
        let strength = values.next().unwrap_or(0.0);
        Self {
            others: values.collect(),
            strength,
            range: effect.parameters[0].typical,
            effect: effect.clone(),
        }
    }

    /// Name of the effect.
    pub fn name(&self) -> &str {
        &self.effect.name
    }

    /// Adds the effect to `reality`.
    pub fn apply(&self, reality: &mut Reality) {
        let names = self.effect.parameters.iter().map(|p| p.name.as_str());
        let values = core::iter::once(self.strength).chain(self.others.iter().copied());
        let parameters: Vec<(&str, f64)> = names.zip(values).collect();
        reality.own = Some(OwnTorque::new(self.effect.torque.clone(), &parameters));
    }
}
