//! Results of the blind check, stored with date, machine and commit.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::origin::Origin;
use super::table::row;
use crate::Failure;

/// Folder of the results in the repository.
const FOLDER: &str = "docs/figures";
/// Prefix of the names of the result files.
const PREFIX: &str = "blind-";
/// Prefix of the results on virtual boards.
const BOARD_PREFIX: &str = "blind-board-";
/// Names of the result rows in the summary.
const CONFIDENT: &str = "names given 0.9 or more that are right";
const TIME: &str = "time of a diagnosis, 95th percentile, s";

/// Results of one set of cases.
#[derive(Debug, Serialize, Deserialize)]
struct Set {
    /// Seed of the cases. A set that combines several sets has several seeds.
    seeds: Vec<u64>,
    cases: u64,
    /// Whether each device has several causes.
    is_messy: bool,
    /// Whether the recordings come from experiments on virtual boards.
    #[serde(default)]
    is_board: bool,
    origin: Origin,
    rows: Vec<Measured>,
}

/// One row of the result table.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Measured {
    what: String,
    goal: Value,
    measured: Option<f64>,
    cases: u64,
    percent: bool,
}

/// The keys of the JSON of `paddle gap blind` that are used here.
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
    #[serde(default)]
    board: bool,
}

#[derive(Debug, Deserialize)]
struct Summary {
    rows: Vec<Measured>,
    calibration: Option<Calibration>,
}

#[derive(Debug, Deserialize)]
struct Calibration {
    confident: Confident,
}

/// Effects that were named with a confidence of 0.9 or more.
#[derive(Debug, Deserialize)]
struct Confident {
    given: u64,
    right: u64,
}

impl From<Confident> for Measured {
    fn from(names: Confident) -> Self {
        Self {
            what: CONFIDENT.into(),
            goal: Value::Null,
            measured: (names.given > 0).then(|| names.right as f64 / names.given as f64),
            cases: names.given,
            percent: true,
        }
    }
}

/// Stores the result of a blind check. Returns the path of the stored file.
///
/// # Errors
/// Returns a [`Failure`] if the file is not a result of the blind check.
pub fn keep(path: &Path) -> Result<PathBuf, Failure> {
    let text = fs::read_to_string(path).map_err(|e| Failure::file(path, e))?;
    let json = |e| Failure::Json(path.display().to_string(), e);
    let answer: Answer = serde_json::from_str(&text).map_err(json)?;
    let Summary { rows, calibration } = answer.summary;
    let set = Set {
        seeds: answer.sets.iter().map(|set| set.seed).collect(),
        cases: answer.sets.iter().map(|set| set.cases).sum(),
        is_messy: answer.sets.iter().any(|set| set.messy),
        is_board: answer.sets.iter().any(|set| set.board),
        origin: Origin::now(&answer.commit)?,
        rows: rows
            .into_iter()
            .chain(calibration.map(|calibration| calibration.confident.into()))
            .collect(),
    };
    let seeds: Vec<String> = set.seeds.iter().map(u64::to_string).collect();
    // A clean set and a messy set can have the same seed.
    let kind = if set.is_messy { "messy" } else { "clean" };
    let prefix = if set.is_board { BOARD_PREFIX } else { PREFIX };
    let name = format!("{prefix}{kind}-{}.json", seeds.join("-"));
    let kept = firmware_build::root().join(FOLDER).join(name);
    let text = serde_json::to_string_pretty(&set).map_err(json)?;
    if let Some(folder) = kept.parent() {
        fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    }
    fs::write(&kept, text + "\n").map_err(|e| Failure::file(&kept, e))?;
    Ok(kept)
}

/// All stored sets, in the order of their files.
pub struct Sets(Vec<Set>);

impl Sets {
    /// Reads the stored sets.
    ///
    /// # Errors
    /// Returns a [`Failure`] if a file is not a set.
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

    /// The table of all sets of a kind. Returns `None` if there are none.
    pub fn table(&self, kind: Kind) -> Option<String> {
        table(&self.of(kind))
    }

    fn of(&self, kind: Kind) -> Vec<&Set> {
        let sets = self.0.iter();
        sets.filter(|set| set.kind() == kind).collect()
    }

    /// The summary over all sets of both kinds. Returns `None` if there is no set of one of the kinds.
    pub fn summary(&self) -> Option<String> {
        let [clean, messy] = [Kind::Clean, Kind::Messy].map(|kind| self.of(kind));
        if clean.is_empty() || messy.is_empty() {
            return None;
        }
        let cases = |sets: &[&Set]| sets.iter().map(|set| set.cases).sum::<u64>();
        let [clean_cases, messy_cases] = [&clean, &messy].map(|sets| cases(sets));
        let latest = clean.iter().chain(&messy).map(|set| set.origin.date());
        let mut text = format!(
            "By `cargo paddle gap blind` on {}: {clean_cases} clean devices, and {messy_cases} with several small causes and wrong numbers \
             beside the dominant cause.\n\n",
            latest.max().unwrap_or_default()
        );
        text.push_str(&row(&["question", "clean devices", "devices with mess"]));
        text.push_str("|---|---|---|\n");
        for [question, of_clean, of_messy] in QUESTIONS {
            let answer =
                |sets: &[&Set], what: &str| counted(sets, what).unwrap_or(NOT_ASKED.into());
            text.push_str(&row(&[
                question,
                &answer(&clean, of_clean),
                &answer(&messy, of_messy),
            ]));
        }
        Some(text)
    }

    /// Time of a diagnosis per kind. Returns `None` if no set is stored.
    pub fn times(&self) -> Option<String> {
        let mut text = row(&["what", "goal", "measured", "command"]);
        text.push_str("|---|---|---|---|\n");
        for set in self.0.iter().filter(|set| !set.is_board) {
            let time = set.rows.iter().find(|row| row.what == TIME)?;
            let (kind, option) = match set.is_messy {
                true => ("device with several causes", " --messy"),
                false => ("clean device", ""),
            };
            let seeds: Vec<String> = set.seeds.iter().map(u64::to_string).collect();
            text.push_str(&row(&[
                &format!("{kind}, 95th percentile of {}, {}", time.cases, set.origin),
                &format!("{} s", goal(time)),
                &format!("{} s", value(time)),
                &format!(
                    "`cargo paddle gap blind{option} --cases {} --seed {}`",
                    set.cases,
                    seeds.join(",")
                ),
            ]));
        }
        (!self.0.is_empty()).then_some(text)
    }

    /// The largest 95th percentile of the diagnosis time over the sets of a kind, s.
    pub fn longest_s(&self, kind: Kind) -> Option<f64> {
        let sets = self.of(kind).into_iter();
        let rows = sets.filter_map(|set| set.rows.iter().find(|row| row.what == TIME));
        rows.filter_map(|row| row.measured).reduce(f64::max)
    }
}

/// Kind of the devices in a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One or two causes, and correct numbers of the model.
    Clean,
    /// Several causes, and errors in the numbers of the model.
    Messy,
    /// Experiments on virtual boards whose paddles have one cause.
    Board,
    /// Experiments on virtual boards whose paddles have several causes, and errors in the numbers of the model.
    MessyBoard,
}

impl Set {
    fn kind(&self) -> Kind {
        match (self.is_board, self.is_messy) {
            (false, false) => Kind::Clean,
            (false, true) => Kind::Messy,
            (true, false) => Kind::Board,
            (true, true) => Kind::MessyBoard,
        }
    }
}

/// Questions of the summary, with the result rows for clean and for messy sets.
const QUESTIONS: [[&str; 3]; 6] = [
    [
        "Is the first name the true (dominant) cause?",
        "first name is the true one",
        "messy: first finding is the dominant cause",
    ],
    [
        "Is it named, or listed as not separable?",
        "true one named or not separable",
        "messy: dominant named or not separable",
    ],
    [
        "Is no confident name given beside a cause that has no name?",
        "outside the vocabulary: no confident wrong name",
        "messy: no name, dominant one outside vocabulary",
    ],
    [
        "In how many cases is a name of 0.7 or more not there?",
        "",
        "messy: cases with a name >= 0.7 not there",
    ],
    [
        "Nothing wrong: does it say so?",
        "nothing wrong: no_gap",
        "",
    ],
    [
        "Two effects: are both named?",
        "two effects: both named",
        "",
    ],
];
const NOT_ASKED: &str = "not in these sets";

/// The sum of the row `what` over all sets, as a count of cases. Returns `None` if no case is in it.
fn counted(sets: &[&Set], what: &str) -> Option<String> {
    let rows = sets
        .iter()
        .flat_map(|set| set.rows.iter().filter(|row| row.what == what));
    let (mut right, mut cases) = (0.0, 0);
    for row in rows {
        right += row.measured.unwrap_or(0.0) * row.cases as f64;
        cases += row.cases;
    }
    (cases > 0).then(|| format!("{right:.0} of {cases}"))
}

fn table(sets: &[&Set]) -> Option<String> {
    let first = sets.first()?;
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
    Some(text)
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

/// A share as a count of cases, or another value as a number.
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
    fn a_share_is_printed_as_a_count_with_its_goal() {
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
        assert_eq!(table(&[&set]).as_deref(), Some(expected));
    }

    fn set(is_messy: bool, what: &str, [right, cases]: [u64; 2]) -> Set {
        let row = |what: &str, measured: f64, percent| Measured {
            what: what.into(),
            goal: Value::Null,
            measured: Some(measured),
            cases,
            percent,
        };
        Set {
            seeds: vec![cases],
            cases,
            is_messy,
            is_board: false,
            origin: serde_json::from_str(
                r#"{"date":"2026-01-02","machine":"m","commit":"0123456789abcdef"}"#,
            )
            .unwrap(),
            rows: vec![
                row(what, right as f64 / cases as f64, true),
                row(TIME, cases as f64, false),
            ],
        }
    }

    #[test]
    fn the_summary_adds_the_cases_of_all_sets_of_a_kind() {
        let clean = [[9, 10], [19, 20]].map(|n| set(false, "first name is the true one", n));
        let messy = set(true, "messy: first finding is the dominant cause", [3, 4]);
        let sets = Sets(clean.into_iter().chain([messy]).collect());
        let summary = sets.summary().unwrap();
        let first = "| Is the first name the true (dominant) cause? | 28 of 30 | 3 of 4 |\n";
        assert!(summary.contains(first), "{summary}");
        assert!(
            summary.contains("30 clean devices, and 4 with"),
            "{summary}"
        );
        assert!(summary.contains(NOT_ASKED), "{summary}");
        assert_eq!(sets.longest_s(Kind::Clean), Some(20.0));
        let times = sets.times().unwrap();
        assert!(times.contains("--messy --cases 4 --seed 4"), "{times}");
    }

    #[test]
    fn a_board_set_is_in_its_own_table_only() {
        let clean = set(false, "first name is the true one", [9, 10]);
        let board = Set {
            is_board: true,
            ..set(false, "first name is the hidden effect", [17, 20])
        };
        let sets = Sets(vec![clean, board]);
        let table = sets.table(Kind::Board).unwrap();
        assert!(table.contains("| 17 of 20 |"), "{table}");
        let [clean, times] = [sets.table(Kind::Clean), sets.times()].map(Option::unwrap);
        assert!(!clean.contains("seed 20"), "{clean}");
        assert!(!times.contains("--seed 20"), "{times}");
        assert_eq!(sets.table(Kind::MessyBoard), None);
    }

    #[test]
    fn a_table_without_sets_is_none() {
        let sets = Sets(vec![set(false, "first name is the true one", [1, 1])]);
        assert!(sets.table(Kind::Clean).is_some());
        assert_eq!(sets.table(Kind::Messy), None);
        assert_eq!(sets.summary(), None);
        assert_eq!(Sets(Vec::new()).times(), None);
    }
}
