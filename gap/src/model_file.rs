//! A corrected model as a self-contained TOML file.

use crate::diagnose::{CorrectedEffect, CorrectedModel};
use crate::missing_torque::table::Table;
use host_sim::effects::{self, Effect, EffectError};
use recording::{Model, NoModel, Recording, plain_message};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

/// Version of this format.
const FORMAT: u32 = 1;

/// The content of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    format: u32,
    /// [`Model::angle_rad`], if it is not 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    angle_rad: Option<f64>,
    model: Model,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    effects: Vec<Entry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    moments: Vec<Moment>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tables: Vec<Table>,
}

/// A permanent effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    sensor_on_load: bool,
    parameters: BTreeMap<String, f64>,
}

/// An effect that is bound to instants of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Moment {
    recording: String,
    fingerprint: String,
    name: String,
    parameters: BTreeMap<String, f64>,
}

/// The reason why a model file cannot be used. Each message names the cause and, after the semicolon, the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelFileError {
    /// The text is not TOML, or a key is missing, unknown or of the wrong type.
    #[error("{0}; write it as `paddle gap diagnose --save-model` does")]
    Toml(String),
    /// The file has another version of the format.
    #[error("format {0} is not known; this program reads `format = 1`")]
    Format(u32),
    /// An effect or one of its parameters is not valid.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// A parameter is missing.
    #[error("effect '{effect}' lacks parameter '{parameter}'; add it")]
    Missing {
        /// The effect.
        effect: &'static str,
        /// The parameter.
        parameter: String,
    },
    /// A model parameter is not valid.
    #[error("[model]: {0}")]
    Model(#[from] NoModel),
    /// A table is not valid.
    #[error(
        "[[tables]] needs ascending values in `at` and as many values in `torque`; write it as `--with-tables` does"
    )]
    Table,
    /// The angle of a position unit is not valid.
    #[error("angle_rad is {0}; it must be above 0")]
    Angle(f64),
}

/// An effect that was left out because it is bound to instants of another recording.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{effect} is bound to instants of the recording '{recording}' and is ignored here")]
pub struct LeftOut {
    /// The effect.
    pub effect: &'static str,
    /// Title of the recording.
    pub recording: String,
}

impl ModelFile {
    /// The file of a corrected model that was found on `recording`.
    pub fn new(corrected: &CorrectedModel, recording: &Recording) -> Self {
        let fingerprint = fingerprint(recording);
        let (moments, effects): (Vec<_>, Vec<_>) = corrected
            .effects
            .iter()
            .partition(|corrected| corrected.effect.is_event());
        let moment = |corrected: &CorrectedEffect| Moment {
            recording: recording.title.clone(),
            fingerprint: fingerprint.clone(),
            name: corrected.effect.kind.name.to_owned(),
            parameters: named(&corrected.effect),
        };
        let entry = |corrected: &CorrectedEffect| Entry {
            name: corrected.effect.kind.name.to_owned(),
            sensor_on_load: corrected.sensor_on_load,
            parameters: named(&corrected.effect),
        };
        Self {
            format: FORMAT,
            angle_rad: Some(corrected.model.angle_rad).filter(|angle_rad| *angle_rad != 1.0),
            model: corrected.model,
            effects: effects.into_iter().map(entry).collect(),
            moments: moments.into_iter().map(moment).collect(),
            tables: corrected.tables.clone(),
        }
    }

    /// The model for `recording`, and the effects that are bound to instants of another recording.
    ///
    /// # Errors
    ///
    /// [`ModelFileError`] for an effect or a parameter that is not valid.
    pub fn on(
        &self,
        recording: &Recording,
    ) -> Result<(CorrectedModel, Vec<LeftOut>), ModelFileError> {
        self.of_moments(Some(&fingerprint(recording)))
    }

    /// The model without a recording, and the effects that are bound to instants of one.
    ///
    /// # Errors
    ///
    /// As [`Self::on`].
    pub fn apart(&self) -> Result<(CorrectedModel, Vec<LeftOut>), ModelFileError> {
        self.of_moments(None)
    }

    /// The model with the effects that are bound to instants of the recording with this fingerprint.
    fn of_moments(
        &self,
        here: Option<&str>,
    ) -> Result<(CorrectedModel, Vec<LeftOut>), ModelFileError> {
        let model = Model {
            angle_rad: self.angle_rad.unwrap_or(1.0),
            ..self.model
        };
        model.check()?;
        if !(model.angle_rad > 0.0 && model.angle_rad.is_finite()) {
            return Err(ModelFileError::Angle(model.angle_rad));
        }
        let mut all: Vec<CorrectedEffect> = Vec::new();
        for entry in &self.effects {
            all.push(CorrectedEffect {
                effect: effect(&entry.name, &entry.parameters)?,
                sensor_on_load: entry.sensor_on_load,
            });
        }
        effects::check_distinct(all.iter().map(|corrected| &corrected.effect))?;
        let mut left_out = Vec::new();
        for moment in &self.moments {
            let effect = effect(&moment.name, &moment.parameters)?;
            if Some(moment.fingerprint.as_str()) == here {
                all.push(CorrectedEffect {
                    effect,
                    sensor_on_load: false,
                });
            } else {
                left_out.push(LeftOut {
                    effect: effect.kind.name,
                    recording: moment.recording.clone(),
                });
            }
        }
        if self.tables.iter().any(|table| !table.is_sound()) {
            return Err(ModelFileError::Table);
        }
        let corrected = CorrectedModel {
            model,
            effects: all,
            tables: self.tables.clone(),
        };
        Ok((corrected, left_out))
    }
}

impl fmt::Display for ModelFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&toml::to_string(self).map_err(|_| fmt::Error)?)
    }
}

impl FromStr for ModelFile {
    type Err = ModelFileError;

    fn from_str(text: &str) -> Result<Self, ModelFileError> {
        let file: Self = toml::from_str(text).map_err(|error| {
            let line = error
                .span()
                .map(|span| 1 + text[..span.start].matches('\n').count());
            let at = line.map_or(String::new(), |line| format!("line {line}: "));
            ModelFileError::Toml(format!("{at}{}", plain_message(error.message())))
        })?;
        match file.format {
            FORMAT => Ok(file),
            other => Err(ModelFileError::Format(other)),
        }
    }
}

fn named(effect: &Effect) -> BTreeMap<String, f64> {
    let count = effect.values.len();
    let values = effect.kind.held(&effect.values).into_iter().enumerate();
    values
        .map(|(place, value)| (effect.kind.value_name(place, count), value))
        .collect()
}

fn effect(name: &str, parameters: &BTreeMap<String, f64>) -> Result<Effect, ModelFileError> {
    let kind = effects::kind(name).ok_or_else(|| EffectError::Kind(name.to_owned()))?;
    let wanted: Vec<&str> = parameters.keys().map(String::as_str).collect();
    let names = kind.value_names(&wanted);
    if let Some(unknown) = parameters.keys().find(|name| !names.contains(name)) {
        let known: Vec<_> = kind.parameters.iter().map(|p| p.name).collect();
        return Err(EffectError::Parameter {
            kind: kind.name,
            name: unknown.clone(),
            known: known.join(", "),
        }
        .into());
    }
    let values = names.into_iter().enumerate();
    let values = values.map(|(place, name)| match parameters.get(&name) {
        Some(value) => Ok(kind.checked(place, &name, *value)?),
        None => Err(ModelFileError::Missing {
            effect: kind.name,
            parameter: name,
        }),
    });
    Ok(Effect {
        kind,
        values: values.collect::<Result<_, _>>()?,
    })
}

/// The fingerprint of a recording, which does not depend on its title: a hash of all times and positions (FNV-1a, G. Fowler, L. C. Noll
/// and K.-P. Vo; RFC 9923).
fn fingerprint(recording: &Recording) -> String {
    const OFFSET_BASIS: u64 = 0xCBF2_9CE4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01B3;
    let columns = recording.runs.iter().flat_map(|r| [&r.time, &r.position]);
    let bytes = columns.flatten().flat_map(|value| value.to_le_bytes());
    let hash = bytes.fold(OFFSET_BASIS, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(PRIME)
    });
    format!("{hash:016x}")
}
