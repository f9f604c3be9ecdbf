//! A device as a TOML file: changes from a base model, effects, and settings of the control core.
//!
//! ```toml
//! with = ["stribeck:static_ratio=1.4"]
//!
//! [model]        # as in a recording
//! viscous = 3.9e-3
//!
//! [settings]     # as on the console
//! pid.kp = 0.05
//! ```

use crate::failure::Failure;
use gap::ModelFile;
use gap::model_file::ModelFileError;
use haptic_paddle::settings::Settings;
use host_sim::device::Device;
use host_sim::effects::{Effect, check_distinct};
use recording::{Model, plain_message, read_text};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The content of the file.
#[derive(Debug)]
pub struct DeviceFile {
    path: PathBuf,
    model: Table,
    with: Vec<Effect>,
    settings: Vec<(String, String)>,
}

impl DeviceFile {
    /// Reads the file.
    ///
    /// # Errors
    /// Returns a [`Failure`] that names the file, the key and a remedy.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = read_text(path, CHECK_THE_NAME)?;
        let wrong = |cause: String| Failure::DeviceFile {
            path: path.to_owned(),
            cause,
        };
        let table: Table = text
            .parse()
            .map_err(|error: toml::de::Error| wrong(placed(&error, &text)))?;
        let mut file = Self {
            path: path.to_owned(),
            model: Table::new(),
            with: Vec::new(),
            settings: Vec::new(),
        };
        for (key, value) in table {
            match (key.as_str(), value) {
                ("model", Value::Table(model)) => file.model = model,
                ("settings", Value::Table(settings)) => flatten("", settings, &mut file.settings),
                ("with", Value::Array(effects)) => {
                    for effect in effects {
                        let text = effect.as_str().ok_or_else(|| {
                            wrong(format!("with: {effect} is no text; write effects as in with = [\"backlash\"]"))
                        })?;
                        file.with
                            .push(text.parse().map_err(|e| wrong(format!("with: {e}")))?);
                    }
                    check_distinct(&file.with).map_err(|e| wrong(format!("with: {e}")))?;
                }
                _ => {
                    return Err(wrong(format!(
                        "`{key}` is not understood; it may hold [model], [settings] and with = [\"effect\"]"
                    )));
                }
            }
        }
        // A tolerance states how well a number is known. It does not change the device.
        file.model.remove("tolerance");
        let says_nothing =
            file.model.is_empty() && file.with.is_empty() && file.settings.is_empty();
        if says_nothing {
            return Err(wrong(
                "the file says nothing; give [model], [settings] or with = [\"effect\"]".into(),
            ));
        }
        Ok(file)
    }

    /// The device that results from applying the file to `base`.
    ///
    /// # Errors
    /// Returns [`Failure::DeviceFile`] for invalid numbers.
    pub fn device(&self, base: &Model) -> Result<Device, Failure> {
        let mut device = Device::nominal(&self.model(base)?);
        for effect in &self.with {
            effect.install(&mut device);
        }
        Ok(device)
    }

    /// The numbers of `base`, with those of the file in their place.
    ///
    /// # Errors
    /// Returns [`Failure::DeviceFile`] for invalid numbers.
    pub fn model(&self, base: &Model) -> Result<Model, Failure> {
        let wrong = |cause: String| Failure::DeviceFile {
            path: self.path.clone(),
            cause: format!("[model]: {cause}"),
        };
        let mut table = Table::try_from(base).map_err(|error| wrong(error.to_string()))?;
        table.extend(self.model.clone());
        let model: Model = table.try_into().map_err(|error: toml::de::Error| {
            // A table value has no line number, so the error names the key whose value is not a number.
            let is_number = |value: &Value| value.is_float() || value.is_integer();
            let plain = plain_message(error.message());
            let mut numbers = self.model.iter().filter(|(name, _)| *name != "travel");
            match numbers
                .find(|(name, value)| Model::NAMES.contains(&name.as_str()) && !is_number(value))
            {
                Some((name, value)) => wrong(format!("`{name}` is {value}; it must be a number")),
                None => wrong(plain),
            }
        })?;
        model.check().map_err(|error| wrong(error.to_string()))?;
        Ok(model)
    }

    /// The effects that the file adds.
    pub fn effects(&self) -> &[Effect] {
        &self.with
    }

    /// Whether the file has settings of the control core and nothing else.
    pub fn has_settings_alone(&self) -> bool {
        self.model.is_empty() && self.with.is_empty()
    }

    /// Whether the file has settings of the control core.
    pub fn has_settings(&self) -> bool {
        !self.settings.is_empty()
    }

    /// Applies the settings of the file to `settings`.
    ///
    /// # Errors
    /// Returns [`Failure::DeviceFile`] for a setting that is refused.
    pub fn apply(&self, settings: &mut Settings) -> Result<(), Failure> {
        for (name, value) in &self.settings {
            settings
                .set(name, value)
                .map_err(|error| Failure::DeviceFile {
                    path: self.path.clone(),
                    cause: format!("[settings]: {}", Failure::setting(name, error)),
                })?;
        }
        Ok(())
    }
}

/// Whether `paddle gap diagnose --save-model` wrote the file. Such a file has a key `format` and needs no base model.
///
/// # Errors
/// Returns [`Failure::Recording`] for a file that is not text.
pub fn stands_alone(path: &Path) -> Result<bool, Failure> {
    let text = read_text(path, CHECK_THE_NAME)?;
    Ok(text
        .parse::<Table>()
        .is_ok_and(|table| table.contains_key("format")))
}

/// Reads a model that `paddle gap diagnose --save-model` wrote. A model that was saved with `--effects-only` takes its
/// numbers from `base`.
///
/// # Errors
/// Returns a [`Failure`] for a file that cannot be used, such as a file with effects only if there is no `base`.
pub fn saved_model(path: &Path, base: Option<&Model>) -> Result<ModelFile, Failure> {
    let text = read_text(path, CHECK_THE_NAME)?;
    let wrong = |cause| Failure::ModelFile {
        path: path.to_owned(),
        cause,
    };
    let table = text.parse::<Table>().ok();
    let Some(mut table) = table.filter(|table| !table.contains_key("model")) else {
        return text.parse().map_err(wrong);
    };
    let Some(base) = base else {
        return Err(Failure::EffectsAlone(path.to_owned()));
    };
    if table.get("format").and_then(Value::as_integer) != Some(1) {
        // The parser of model files reports the error.
        return text.parse().map_err(wrong);
    }
    let failed = |message: &str| wrong(ModelFileError::Toml(plain_message(message)));
    let numbers = Table::try_from(base).map_err(|error| failed(&error.to_string()))?;
    table.insert("model".into(), Value::Table(numbers));
    table.insert("angle_rad".into(), Value::Float(base.angle_rad));
    table
        .try_into()
        .map_err(|error: toml::de::Error| failed(error.message()))
}

/// The text of a saved model without its `[model]`. Only the effects remain, for use with another nominal model.
pub fn effects_alone(saved: &str) -> String {
    let mut is_model = false;
    let kept = saved.lines().filter(|line| {
        if line.starts_with('[') {
            is_model = *line == "[model]";
        }
        // The key `angle_rad` belongs to the model.
        !is_model && !line.starts_with("angle_rad")
    });
    kept.map(|line| format!("{line}\n")).collect()
}

/// Lists dotted names with their values in the syntax of the console.
fn flatten(prefix: &str, table: Table, into: &mut Vec<(String, String)>) {
    for (key, value) in table {
        let name = format!("{prefix}{key}");
        match value {
            Value::Table(inner) => flatten(&format!("{name}."), inner, into),
            Value::String(text) => into.push((name, text)),
            Value::Boolean(on) => into.push((name, if on { "on" } else { "off" }.into())),
            other => into.push((name, other.to_string())),
        }
    }
}

/// The message of a TOML error in `text`, with its line number.
fn placed(error: &toml::de::Error, text: &str) -> String {
    let line = error
        .span()
        .map(|span| 1 + text[..span.start].matches('\n').count());
    let at = line.map_or(String::new(), |line| format!("line {line}: "));
    format!("{at}{}", plain_message(error.message()))
}

/// Remedy for a file that cannot be opened.
pub const CHECK_THE_NAME: &str = "check the name";
