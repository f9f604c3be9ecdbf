//! Settings of the control core as a TOML file: the `[settings]` of a device file, one setting per line.

use haptic_paddle::settings::{FIELDS, Field, Settings};
use std::fmt::Write;

/// All settings, each with its unit in a comment.
pub fn text(settings: &Settings) -> String {
    let mut text = "[settings]\n".to_owned();
    for field in FIELDS {
        let _ = write!(text, "{} = {}", field.name, value(field, settings));
        let _ = match field.unit {
            "" => writeln!(text),
            unit => writeln!(text, "  # {unit}"),
        };
    }
    text
}

/// The value of a setting in TOML syntax. A choice is a string.
fn value(field: &'static Field, settings: &Settings) -> String {
    let value = field.shown(settings).value().to_string();
    match value.parse::<f64>() {
        Ok(_) => value,
        Err(_) => toml::Value::from(value).to_string(),
    }
}

/// A setting with two different values.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the setting.
    pub name: &'static str,
    /// Unit of the setting. It is empty if there is none.
    pub unit: &'static str,
    /// The two values in the syntax of the console.
    pub values: [String; 2],
}

/// The settings that differ, in the order of the console.
pub fn differences(from: &Settings, to: &Settings) -> Vec<Difference> {
    FIELDS
        .iter()
        .map(|field| Difference {
            name: field.name,
            unit: field.unit,
            values: [from, to].map(|settings| field.shown(settings).value().to_string()),
        })
        .filter(|difference| difference.values[0] != difference.values[1])
        .collect()
}

/// The differences as text, one line each.
pub fn told(differences: &[Difference]) -> String {
    let lines = differences.iter().map(|difference| {
        let [before, after] = &difference.values;
        let name = difference.name;
        let line = format!(
            "  {name:<32} {before:>12} -> {after:<12} {}",
            difference.unit
        );
        format!("{}\n", line.trim_end())
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_settings_that_differ_are_listed() {
        let mut changed = Settings::default();
        changed.set("pid.kp", "0.06").unwrap();
        changed.set("estimate.sensor", "hall").unwrap();
        let found = differences(&Settings::default(), &changed);
        let names: Vec<_> = found.iter().map(|found| found.name).collect();
        assert_eq!(names, ["pid.kp", "estimate.sensor"]);
        let told = told(&found);
        assert!(told.contains("0.05 -> 0.06"), "{told}");
        assert_eq!(differences(&changed, &changed), []);
    }

    #[test]
    fn the_file_is_toml_and_has_every_setting() {
        let table: toml::Table = text(&Settings::default()).parse().unwrap();
        let groups = table["settings"].as_table().unwrap();
        let values = groups.values().map(|group| group.as_table().unwrap().len());
        assert_eq!(values.sum::<usize>(), FIELDS.len());
        assert_eq!(groups["estimate"]["sensor"].as_str(), Some("encoder"));
    }
}
