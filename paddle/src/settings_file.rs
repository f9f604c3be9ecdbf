//! Settings of the control core as a TOML file: the `[settings]` of a device file, one line each.

use haptic_paddle::settings::{FIELDS, Field, Settings};
use std::fmt::Write;

/// All settings, each with its unit as a remark.
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

/// A setting as TOML has it: a choice is a text.
fn value(field: &'static Field, settings: &Settings) -> String {
    let value = field.shown(settings).value().to_string();
    match value.parse::<f64>() {
        Ok(_) => value,
        Err(_) => toml::Value::from(value).to_string(),
    }
}

/// A setting that differs.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Its name.
    pub name: &'static str,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// As the console writes it, before and after.
    pub values: [String; 2],
}

/// What differs from one to the other, in the order of the console.
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

/// For people, a line each.
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
    fn what_differs_is_told_and_nothing_else() {
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
