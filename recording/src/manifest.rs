//! `recording.toml` as it stands in the file.

use std::collections::BTreeMap;

use serde::ser::{Error as _, SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Fault};
use crate::keys::{self, Lines};
use crate::text::plain_message;
use crate::{Drive, InputSampling, Model, Oddity, Pid, Recording, Run, Sensor, Tolerance, Units};

/// Name of the manifest inside the folder.
pub(crate) const FILE: &str = "recording.toml";

/// The one version of the format.
pub(crate) const FORMAT: u32 = 1;

/// The whole manifest. `M` is the `[model]` table: without its tolerances on the way in, with them on the way out.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Manifest<M> {
    pub format: u32,
    #[serde(default)]
    pub title: String,
    pub horizon: f64,
    #[serde(default = "restart_half_width")]
    pub restart_half_width: f64,
    #[serde(default)]
    pub units: Units,
    pub model: M,
    #[serde(default)]
    pub sensor: BTreeMap<String, Sensor>,
    #[serde(default)]
    pub runs: Vec<RunEntry>,
}

fn restart_half_width() -> f64 {
    Recording::RESTART_HALF_WIDTH
}

/// One of `[[runs]]`.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct RunEntry {
    pub file: String,
    pub drive: Drive,
    #[serde(default)]
    pub input_time_std: f64,
    #[serde(default, skip_serializing_if = "is_mean")]
    pub input_sampling: InputSampling,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub model: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<Controller>,
}

fn is_mean(sampling: &InputSampling) -> bool {
    *sampling == InputSampling::Mean
}

/// `[runs.controller]`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub(crate) enum Controller {
    Pid(Pid),
}

/// `[model]` with its tolerances, without the numbers that are not stated.
struct ModelTable<'a> {
    model: &'a Model,
    unstated: &'a [&'static str],
    tolerance: &'a Tolerance,
}

impl Serialize for ModelTable<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let numbers = toml::Table::try_from(self.model).map_err(S::Error::custom)?;
        let mut table = serializer.serialize_map(None)?;
        for name in Model::NAMES {
            if let Some(value) = numbers.get(name)
                && !self.unstated.contains(&name)
            {
                table.serialize_entry(name, value)?;
            }
        }
        if !self.tolerance.is_empty() {
            table.serialize_entry("tolerance", self.tolerance)?;
        }
        table.end()
    }
}

/// A manifest that was read, with the lines on which its keys stand.
pub(crate) struct Parsed {
    pub manifest: Manifest<Model>,
    pub tolerance: Tolerance,
    pub unstated: Vec<&'static str>,
    pub lines: Lines,
    pub oddities: Vec<Oddity>,
}

/// Reads the text of a manifest.
///
/// # Errors
/// Whatever is not TOML or not of the contract's shape; numbers are not judged here.
pub(crate) fn parse(text: &str) -> Result<Parsed, Error> {
    let failed = |error: toml::de::Error| {
        let message = plain_message(error.message());
        Error::new(Fault::Toml { message })
            .at(error.span().map(|span| keys::line_at(text, span.start)))
    };
    let mut root = toml::de::DeTable::parse(text).map_err(failed)?;
    let lines = Lines::of(text, root.get_ref());
    let format = root
        .get_ref()
        .get("format")
        .and_then(|value| value.get_ref().as_integer());
    if let Some(found) = format
        .map(|integer| integer.to_string())
        .filter(|found| *found != FORMAT.to_string())
    {
        return Err(Error::new(Fault::Format { found }).at(lines.get("format")));
    }
    let oddities = keys::check(text, root.get_ref())?;

    let model = root.get_mut().get_mut("model").map(toml::Spanned::get_mut);
    let (unstated, tolerance) = match model {
        Some(toml::de::DeValue::Table(model)) => {
            let mut essential = Model::ESSENTIAL.to_vec();
            essential.retain(|name| !model.contains_key(*name));
            (essential, model.remove("tolerance"))
        }
        _ => (Vec::new(), None),
    };
    let tolerance = match tolerance {
        Some(table) => {
            let span = table.span();
            Tolerance::deserialize(toml::de::ValueDeserializer::from(table)).map_err(|error| {
                let line = keys::line_at(text, error.span().unwrap_or(span).start);
                Error::new(Fault::Toml {
                    message: plain_message(error.message()),
                })
                .at(Some(line))
            })?
        }
        None => Tolerance::default(),
    };
    let manifest = Manifest::deserialize(toml::Deserializer::from(root)).map_err(failed)?;
    Ok(Parsed {
        manifest,
        tolerance,
        unstated,
        lines,
        oddities,
    })
}

/// The text of the manifest of `recording`.
pub(crate) fn text(recording: &Recording) -> Result<String, toml::ser::Error> {
    let entry = |run: &Run| RunEntry {
        file: run.file.clone(),
        drive: run.drive,
        input_time_std: run.input_time_std,
        input_sampling: run.input_sampling,
        model: run.numbers.clone(),
        controller: run.controller.map(Controller::Pid),
    };
    toml::to_string(&Manifest {
        format: FORMAT,
        title: recording.title.clone(),
        horizon: recording.horizon,
        restart_half_width: recording.restart_half_width,
        units: recording.units.clone(),
        model: ModelTable {
            model: &recording.model,
            unstated: &recording.unstated,
            tolerance: &recording.tolerance,
        },
        sensor: recording.sensors.clone(),
        runs: recording.runs.iter().map(entry).collect(),
    })
}
