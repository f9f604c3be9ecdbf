//! The keys of the manifest: their lines, and unknown ones.

use std::collections::BTreeMap;

use toml::de::{DeTable, DeValue};

use crate::error::{Error, Fault};
use crate::{Model, Motor, Oddity};

const TOP: [&str; 9] = [
    "format",
    "title",
    "horizon",
    "restart_half_width",
    "units",
    "motor",
    "model",
    "sensor",
    "runs",
];
const UNITS: [&str; 2] = ["position", "input"];
const SERVO: [&str; 4] = ["stiffness", "damping", "speed_limit", "deadband"];
const SENSOR: [&str; 3] = ["resolution", "noise", "cutoff_hz"];
const RUN: [&str; 6] = [
    "file",
    "drive",
    "input_time_std",
    "input_sampling",
    "model",
    "controller",
];
const PID: [&str; 6] = ["kind", "kp", "ki", "kd", "period", "position_cutoff_hz"];

/// Least similarity of two names (Jaro-Winkler, 0 to 1) for a suggestion.
const SLIP: f64 = 0.8;

/// The line of every key by its path, such as `model.inertia` or `runs.0.file`.
pub(crate) struct Lines(BTreeMap<String, usize>);

impl Lines {
    pub fn of(text: &str, root: &DeTable) -> Self {
        // The keys are not sorted by position, so the line of each is found by a search.
        let starts: Vec<usize> = text
            .bytes()
            .enumerate()
            .filter(|(_, b)| *b == b'\n')
            .map(|(k, _)| k)
            .collect();
        let mut lines = BTreeMap::new();
        walk(root, "", &mut |path, at| {
            lines.insert(
                path.to_owned(),
                starts.partition_point(|start| *start < at) + 1,
            );
        });
        Self(lines)
    }

    pub fn get(&self, path: &str) -> Option<usize> {
        self.0.get(path).copied()
    }
}

fn walk(table: &DeTable, path: &str, visit: &mut impl FnMut(&str, usize)) {
    for (key, value) in table {
        let path = format!("{path}{}", key.get_ref());
        visit(&path, key.span().start);
        match value.get_ref() {
            DeValue::Table(inner) => walk(inner, &format!("{path}."), visit),
            DeValue::Array(items) => {
                for (k, item) in items.iter().enumerate() {
                    let path = format!("{path}.{k}");
                    visit(&path, item.span().start);
                    if let DeValue::Table(inner) = item.get_ref() {
                        walk(inner, &format!("{path}."), visit);
                    }
                }
            }
            _ => {}
        }
    }
}

/// The line, from 1, that contains the byte `at` of `text`.
pub(crate) fn line_at(text: &str, at: usize) -> usize {
    text.bytes().take(at).filter(|byte| *byte == b'\n').count() + 1
}

/// The known name most similar to `name`, if it is similar enough.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let scored = known
        .into_iter()
        .map(|known| (strsim::jaro_winkler(&name, known), known));
    scored
        .filter(|(score, _)| *score >= SLIP)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}

/// Finds unknown keys. They are errors in tables where a number would silently keep its default. In other tables, where
/// people may write notes, they are oddities.
pub(crate) fn check(text: &str, root: &DeTable) -> Result<Vec<Oddity>, Error> {
    let strict = |name: &str, table: &DeTable, known: &[&'static str]| -> Result<(), Error> {
        let Some((key, _)) = table
            .iter()
            .find(|(key, _)| !known.contains(&key.get_ref().as_ref()))
        else {
            return Ok(());
        };
        let fault = Fault::UnknownKey {
            table: name.to_owned(),
            key: key.get_ref().to_string(),
            nearest: nearest(key.get_ref(), known.iter().copied()),
            known: known.join(", "),
        };
        Err(Error::new(fault).at(Some(line_at(text, key.span().start))))
    };
    let mut oddities = Vec::new();
    let mut lenient = |name: &str, table: &DeTable, known: &[&'static str]| {
        for (key, _) in table
            .iter()
            .filter(|(key, _)| !known.contains(&key.get_ref().as_ref()))
        {
            oddities.push(Oddity::UnknownKey {
                line: line_at(text, key.span().start),
                table: name.to_owned(),
                key: key.get_ref().to_string(),
                nearest: nearest(key.get_ref(), known.iter().copied()),
            });
        }
    };

    lenient("the top level", root, &TOP);
    if let Some(units) = table(root, "units") {
        lenient("[units]", units, &UNITS);
    }
    if let Some(motor) = table(root, "motor") {
        strict("[motor]", motor, &Motor::NAMES)?;
    }
    if let Some(model) = table(root, "model") {
        let known: Vec<_> = Model::NAMES
            .into_iter()
            .chain(["servo", "tolerance"])
            .collect();
        strict("[model]", model, &known)?;
        if let Some(servo) = table(model, "servo") {
            strict("[model.servo]", servo, &SERVO)?;
        }
        if let Some(tolerance) = table(model, "tolerance") {
            strict("[model.tolerance]", tolerance, &Model::NAMES)?;
        }
    }
    for (name, sensor) in table(root, "sensor").into_iter().flatten() {
        if let DeValue::Table(sensor) = sensor.get_ref() {
            strict(&format!("[sensor.{}]", name.get_ref()), sensor, &SENSOR)?;
        }
    }
    let runs = root.get("runs").and_then(|runs| runs.get_ref().as_array());
    for run in runs.into_iter().flatten() {
        if let DeValue::Table(run) = run.get_ref() {
            lenient("[[runs]]", run, &RUN);
            if let Some(numbers) = table(run, "model") {
                let known = Model::NAMES.into_iter().filter(|name| *name != "travel");
                strict("[runs.model]", numbers, &known.collect::<Vec<_>>())?;
            }
            if let Some(controller) = table(run, "controller") {
                strict("[runs.controller]", controller, &PID)?;
            }
        }
    }
    Ok(oddities)
}

fn table<'a, 'i>(parent: &'a DeTable<'i>, key: &str) -> Option<&'a DeTable<'i>> {
    parent.get(key).and_then(|value| value.get_ref().as_table())
}
