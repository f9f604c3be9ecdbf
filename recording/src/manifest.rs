//! The file `recording.toml`.

use std::collections::BTreeMap;

use serde::ser::{Error as _, SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Fault};
use crate::keys::{self, Lines};
use crate::text::plain_message;
use crate::{
    Actuator, Drive, InputSampling, Model, Motor, Oddity, Pid, Recording, Run, Sensor, Servo,
    Tolerance, Units,
};

/// Name of the manifest inside the folder.
pub(crate) const FILE: &str = "recording.toml";

/// The supported version of the format.
pub(crate) const FORMAT: u32 = 1;

/// The whole manifest. `M` is the table `[model]`. It is read without tolerances and written with them.
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motor: Option<Motor>,
    pub model: M,
    #[serde(default)]
    pub sensor: BTreeMap<String, Sensor>,
    #[serde(default)]
    pub runs: Vec<RunEntry>,
}

fn restart_half_width() -> f64 {
    Recording::RESTART_HALF_WIDTH
}

/// One table of `[[runs]]`.
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

/// The table `[runs.controller]`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub(crate) enum Controller {
    Pid(Pid),
}

/// The table `[model]` with its servo and tolerances, without numbers that are not stated.
struct ModelTable<'a> {
    model: Model,
    unstated: Vec<&'static str>,
    servo: Option<Servo>,
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
        if let Some(servo) = &self.servo {
            table.serialize_entry("servo", servo)?;
        }
        if !self.tolerance.is_empty() {
            table.serialize_entry("tolerance", self.tolerance)?;
        }
        table.end()
    }
}

/// A parsed manifest with the lines of its keys.
pub(crate) struct Parsed {
    /// The manifest. Its model combines joint and actuator.
    pub manifest: Manifest<Model>,
    pub actuator: Option<Actuator>,
    pub tolerance: Tolerance,
    pub unstated: Vec<&'static str>,
    pub lines: Lines,
    pub oddities: Vec<Oddity>,
}

/// Parses the text of a manifest.
///
/// # Errors
///
/// [`Error`] if the text is not TOML or has the wrong structure. Values are not checked here.
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
    let (stated, servo, tolerance) = match model {
        Some(toml::de::DeValue::Table(model)) => {
            let mut stated = Model::NAMES.to_vec();
            stated.retain(|name| model.contains_key(*name));
            (stated, model.remove("servo"), model.remove("tolerance"))
        }
        _ => (Model::NAMES.to_vec(), None, None),
    };
    let servo: Option<Servo> = servo.map(|table| part(text, table)).transpose()?;
    let tolerance: Option<Tolerance> = tolerance.map(|table| part(text, table)).transpose()?;
    let mut manifest =
        Manifest::<Model>::deserialize(toml::Deserializer::from(root)).map_err(failed)?;
    let actuator = actuator(manifest.motor, servo, &stated).map_err(|fault| {
        let line = lines.get("motor").or(lines.get("model.servo"));
        Error::new(fault).at(line)
    })?;
    let mut unstated = Model::ESSENTIAL.to_vec();
    unstated.retain(|name| !stated.contains(name));
    if let Some(actuator) = &actuator {
        let lacks = |lack| Error::new(Fault::Motor(lack)).at(lines.get("motor"));
        unstated.retain(|name| !actuator.stands_for().contains(name));
        manifest.model = actuator
            .added_to(&manifest.model, &manifest.units)
            .map_err(lacks)?;
        // A run states the friction of the joint itself.
        let viscous = actuator.viscous(&manifest.units).map_err(lacks)?;
        let runs = manifest.runs.iter_mut();
        runs.filter_map(|run| run.model.get_mut("viscous"))
            .for_each(|own| *own += viscous);
    }
    Ok(Parsed {
        manifest,
        actuator,
        tolerance: tolerance.unwrap_or_default(),
        unstated,
        lines,
        oddities,
    })
}

/// Deserialises a table that was removed from the manifest `text`.
fn part<'a, T: Deserialize<'a>>(
    text: &str,
    table: toml::Spanned<toml::de::DeValue<'a>>,
) -> Result<T, Error> {
    let span = table.span();
    T::deserialize(toml::de::ValueDeserializer::from(table)).map_err(|error| {
        let line = keys::line_at(text, error.span().unwrap_or(span).start);
        let message = plain_message(error.message());
        Error::new(Fault::Toml { message }).at(Some(line))
    })
}

/// The actuator, if it is described by a data sheet or as a servo. `stated` lists the numbers that the model states.
fn actuator(
    motor: Option<Motor>,
    servo: Option<Servo>,
    stated: &[&str],
) -> Result<Option<Actuator>, Fault> {
    let actuator = match (motor, servo) {
        (None, None) => return Ok(None),
        (Some(_), Some(_)) => {
            return Err(Fault::SaidTwice {
                one: "[motor]",
                other: "`servo` of [model]",
            });
        }
        (Some(motor), None) => Actuator::Motor(motor),
        (None, Some(servo)) => Actuator::Servo(servo),
    };
    let twice = |name: &&&str| stated.contains(*name);
    let said = match actuator.stands_for().iter().find(twice) {
        None => return Ok(Some(actuator)),
        Some(&"ratio") => "`ratio` of [model]",
        Some(_) => "`stiffness` of [model]",
    };
    Err(Fault::SaidTwice {
        one: actuator.table(),
        other: said,
    })
}

/// Writes the manifest of `recording`.
pub(crate) fn text(recording: &Recording) -> Result<String, toml::ser::Error> {
    let units = &recording.units;
    // An actuator that the model no longer contains is written as numbers of the model.
    let apart = recording.actuator.and_then(|actuator| {
        let joint = actuator.taken_from(&recording.model, units)?;
        Some((actuator, joint, actuator.viscous(units).ok()?))
    });
    let entry = |run: &Run| {
        let mut model = run.numbers.clone();
        if let (Some((.., viscous)), Some(own)) = (&apart, model.get_mut("viscous")) {
            *own -= viscous;
        }
        RunEntry {
            file: run.file.clone(),
            drive: run.drive,
            input_time_std: run.input_time_std,
            input_sampling: run.input_sampling,
            model,
            controller: run.controller.map(Controller::Pid),
        }
    };
    let mut unstated = recording.unstated.clone();
    let (mut motor, mut servo, mut model) = (None, None, recording.model);
    if let Some((actuator, joint, _)) = apart {
        unstated.extend(actuator.stands_for());
        model = joint;
        match actuator {
            Actuator::Motor(own) => motor = Some(own),
            Actuator::Servo(own) => servo = Some(own),
        }
    }
    toml::to_string(&Manifest {
        format: FORMAT,
        title: recording.title.clone(),
        horizon: recording.horizon,
        restart_half_width: recording.restart_half_width,
        units: units.clone(),
        motor,
        model: ModelTable {
            model,
            unstated,
            servo,
            tolerance: &recording.tolerance,
        },
        sensor: recording.sensors.clone(),
        runs: recording.runs.iter().map(entry).collect(),
    })
}
