//! Results of the blind check, kept with when, where and of what they were measured.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::origin::Origin;
use super::table::row;
use crate::Failure;

/// Folder of the results, in the repository.
const FOLDER: &str = "docs/figures";
/// With which the names of their files begin.
const PREFIX: &str = "blind-";

/// One set of cases.
#[derive(Debug, Serialize, Deserialize)]
struct Set {
    /// Of its cases, or of several sets that are scored as one.
    seeds: Vec<u64>,
    cases: u64,
    /// With several causes in each device.
    is_messy: bool,
    origin: Origin,
    rows: Vec<Measured>,
}

/// One row of its table.
#[derive(Debug, Serialize, Deserialize)]
struct Measured {
    what: String,
    goal: Value,
    measured: Option<f64>,
    cases: u64,
    percent: bool,
}

/// What `paddle gap blind --json` writes, as far as it matters here.
#[derive(Debug, Deserialize)]
struct Answer {
    sets: Vec<Drawn>,
    summary: Summary,
    commit: String,
}

#[derive(Debug, Deserialize)]
struct Drawn {
    seed: u64,
    cases: u64,
    messy: bool,
}

#[derive(Debug, Deserialize)]
struct Summary {
    rows: Vec<Measured>,
}

/// Keeps the result of a blind check; the file that holds it.
///
/// # Errors
/// [`Failure`] for a file that is no such result.
pub fn keep(path: &Path) -> Result<PathBuf, Failure> {
    let text = fs::read_to_string(path).map_err(|e| Failure::file(path, e))?;
    let json = |e| Failure::Json(path.display().to_string(), e);
    let answer: Answer = serde_json::from_str(&text).map_err(json)?;
    let set = Set {
        seeds: answer.sets.iter().map(|set| set.seed).collect(),
        cases: answer.sets.iter().map(|set| set.cases).sum(),
        is_messy: answer.sets.iter().any(|set| set.messy),
        origin: Origin::now(&answer.commit)?,
        rows: answer.summary.rows,
    };
    let seeds: Vec<String> = set.seeds.iter().map(u64::to_string).collect();
    let kept = firmware_build::root().join(format!("{FOLDER}/{PREFIX}{}.json", seeds.join("-")));
    let text = serde_json::to_string_pretty(&set).map_err(json)?;
    if let Some(folder) = kept.parent() {
        fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    }
    fs::write(&kept, text + "\n").map_err(|e| Failure::file(&kept, e))?;
    Ok(kept)
}

/// All sets that are kept, in the order of their files.
pub struct Sets(Vec<Set>);

impl Sets {
    /// Reads them.
    ///
    /// # Errors
    /// [`Failure`] for a file that is no set.
    pub fn kept() -> Result<Self, Failure> {
        let folder = firmware_build::root().join(FOLDER);
        let Ok(entries) = fs::read_dir(&folder) else {
            return Ok(Self(Vec::new()));
        };
        let paths = entries.flatten().map(|entry| entry.path());
        let is_set = |path: &PathBuf| {
            let name = path.file_name().map(|name| name.to_string_lossy());
            name.is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(".json"))
        };
        let mut paths: Vec<PathBuf> = paths.filter(is_set).collect();
        paths.sort();
        let sets = paths.iter().map(|path| {
            let text = fs::read_to_string(path).map_err(|e| Failure::file(path, e))?;
            serde_json::from_str(&text).map_err(|e| Failure::Json(path.display().to_string(), e))
        });
        Ok(Self(sets.collect::<Result<_, _>>()?))
    }

    /// The table of all clean, or of all messy sets.
    ///
    /// # Errors
    /// [`Failure`] for another kind.
    pub fn table(&self, kind: &str) -> Result<String, Failure> {
        let is_messy = match kind {
            "clean" => false,
            "messy" => true,
            other => return Err(Failure::NoFigures(format!("accuracy {other}"))),
        };
        let sets: Vec<&Set> = self
            .0
            .iter()
            .filter(|set| set.is_messy == is_messy)
            .collect();
        Ok(table(&sets))
    }
}

fn table(sets: &[&Set]) -> String {
    let Some(first) = sets.first() else {
        return "No set of this kind has been kept.\n".into();
    };
    let headings = sets.iter().map(|set| {
        let seeds: Vec<String> = set.seeds.iter().map(u64::to_string).collect();
        format!("seed {}", seeds.join(", "))
    });
    let headings: Vec<String> = ["".to_owned(), "goal".to_owned()]
        .into_iter()
        .chain(headings)
        .collect();
    let mut text = row(&headings);
    text.push_str(&format!("|{}\n", "---|".repeat(headings.len())));
    for line in &first.rows {
        let mut cells = vec![line.what.clone(), goal(line)];
        for set in sets {
            let same = set.rows.iter().find(|other| other.what == line.what);
            cells.push(same.map_or(String::new(), value));
        }
        text.push_str(&row(&cells));
    }
    text.push('\n');
    for set in sets {
        let seeds: Vec<String> = set.seeds.iter().map(u64::to_string).collect();
        let _ = writeln!(
            text,
            "Seed {}: {} cases, {}.",
            seeds.join(", "),
            set.cases,
            set.origin
        );
    }
    text
}

fn goal(of: &Measured) -> String {
    let number = |value: &Value| {
        let value = value.as_f64().unwrap_or_default();
        match of.percent {
            true => format!("{:.0} %", 100.0 * value),
            false => value.to_string(),
        }
    };
    match (of.goal.get("at_least"), of.goal.get("at_most")) {
        (Some(least), _) => format!("≥ {}", number(least)),
        (_, Some(most)) => format!("≤ {}", number(most)),
        _ => String::new(),
    }
}

/// A share as a count of the cases, anything else as a number.
fn value(of: &Measured) -> String {
    match of.measured {
        None => "no case".into(),
        Some(share) if of.percent => {
            format!("{:.0} of {}", share * of.cases as f64, of.cases)
        }
        Some(number) if number.abs() < 1.0 => format!("{number:.3}"),
        Some(number) => format!("{number:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_told_as_a_count_with_its_goal() {
        let set: Set = serde_json::from_str(
            r#"{"seeds":[7,8],"cases":40,"is_messy":false,"origin":{"date":"2026-01-02",
            "machine":"a processor, 2 cores","commit":"0123456789abcdef"},"rows":[
            {"what":"first","goal":{"at_least":0.95},"measured":0.9,"cases":30,"percent":true},
            {"what":"time, s","goal":{"at_most":3.0},"measured":11.86,"cases":40,"percent":false},
            {"what":"pairs","goal":"none","measured":null,"cases":0,"percent":true}]}"#,
        )
        .unwrap();
        let expected = "|  | goal | seed 7, 8 |\n|---|---|---|\n| first | ≥ 95 % | 27 of 30 |\n\
                        | time, s | ≤ 3 | 11.9 |\n| pairs |  | no case |\n\n\
                        Seed 7, 8: 40 cases, 2026-01-02, commit 0123456789ab, a processor, 2 cores.\n";
        assert_eq!(table(&[&set]), expected);
    }
}
