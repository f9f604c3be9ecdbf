//! Speed of the simulator and of the virtual board, stored with date, machine and commit.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::accuracy::{Kind, Sets};
use super::origin::Origin;
use super::table::row;
use crate::{Failure, cargo, documentation, output, run};

/// File of the results in the repository.
const FILE: &str = "docs/figures/performance.json";
const HOST: &str = "cargo bench -p host-sim";
const BOARD: &str = "cargo bench -p haptic-paddle --bench board";
/// Simulated time of one run of the simulator's benchmarks, s.
const SIMULATED_S: f64 = 2.0;
const PER_NS: f64 = 1e-9;
const PLANT: &str = "plant alone, 2 s step with stick-slip";
const CLOSED_LOOP: &str = "closed loop with the full core, 350 µs";
const BOARD_LOOP: &str = "flashed image with the paddle, position loop, one core";
const MISSED: &str = "control periods of 50 µs missed in 60 s at full load";
/// Rows of the summary.
const SUMMARY: [&str; 4] = [PLANT, CLOSED_LOOP, BOARD_LOOP, MISSED];

/// All rows and their origin.
#[derive(Debug, Serialize, Deserialize)]
pub struct Performance {
    origin: Origin,
    rows: Vec<Row>,
}

/// One measured figure.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    what: String,
    goal: String,
    measured: String,
    command: String,
}

fn file() -> PathBuf {
    firmware_build::root().join(FILE)
}

/// Measures the speeds and stores the results.
///
/// # Errors
/// Returns a [`Failure`] if a benchmark fails or if its output cannot be parsed.
pub fn measure() -> Result<(), Failure> {
    run(&mut cargo(&[
        "bench",
        "--package",
        "host-sim",
        "--bench",
        "step",
    ]))?;
    let mut rows = Vec::new();
    for (name, what, goal) in [
        ("replayed torque", PLANT, 10_000),
        ("closed loop at 350 us", CLOSED_LOOP, 5_000),
        (
            "closed loop with current loop at 50 us",
            "closed loop with the 20 kHz current loop",
            300,
        ),
    ] {
        rows.push(Row {
            what: what.into(),
            goal: format!("≥ {goal} × real time"),
            measured: format!("{:.0} ×", times_real_time(name)?),
            command: HOST.into(),
        });
    }
    let said = output(&mut cargo(&[
        "bench",
        "--package",
        "haptic-paddle",
        "--bench",
        "board",
    ]))?;
    rows.extend(board(&said).ok_or_else(|| Failure::Benchmark(BOARD.into()))?);
    let kept = Performance {
        origin: Origin::now(output(Command::new("git").args(["rev-parse", "HEAD"]))?.trim())?,
        rows,
    };
    let text = serde_json::to_string_pretty(&kept).map_err(|e| Failure::Json(FILE.into(), e))?;
    fs::write(file(), text + "\n").map_err(|e| Failure::file(&file(), e))
}

impl Performance {
    /// The stored results. Returns `None` if there are none.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the file has another content.
    pub fn kept() -> Result<Option<Self>, Failure> {
        if !file().exists() {
            return Ok(None);
        }
        let text = fs::read_to_string(file()).map_err(|e| Failure::file(&file(), e))?;
        let kept = serde_json::from_str(&text).map_err(|e| Failure::Json(FILE.into(), e))?;
        Ok(Some(kept))
    }

    /// Table of all rows.
    pub fn table(&self) -> String {
        let mut table = row(&["what", "goal", "measured", "command"]);
        table.push_str("|---|---|---|---|\n");
        for one in &self.rows {
            table.push_str(&row(&[
                &one.what,
                &one.goal,
                &one.measured,
                &format!("`{}`", one.command),
            ]));
        }
        table.push_str(&format!("\nMeasured on {}.\n", self.origin));
        table
    }

    /// Table of the summary rows, and of the diagnosis time from the `sets` of the blind check.
    pub fn summary(&self, sets: &Sets) -> String {
        let mut table = row(&["what", "goal", "measured"]);
        table.push_str("|---|---|---|\n");
        for one in self
            .rows
            .iter()
            .filter(|row| SUMMARY.contains(&row.what.as_str()))
        {
            table.push_str(&row(&[&one.what, &one.goal, &one.measured]));
        }
        let time = |kind| sets.longest_s(kind).map(|s| format!("{s:.0} s"));
        let times =
            [time(Kind::Clean), time(Kind::Messy)].map(|t| t.unwrap_or("not measured".into()));
        table.push_str(&row(&[
            "diagnosis, 95th percentile: clean device; device with mess",
            "≤ 3 s",
            &times.join("; "),
        ]));
        table
    }
}

/// Reads the result that criterion stored for a benchmark.
fn times_real_time(name: &str) -> Result<f64, Failure> {
    let estimates = format!("criterion/step/{name}/new/estimates.json");
    let path = documentation::target_folder().join(estimates);
    let text = fs::read_to_string(&path).map_err(|e| Failure::file(&path, e))?;
    let json = |e| Failure::Json(path.display().to_string(), e);
    let estimates: Value = serde_json::from_str(&text).map_err(json)?;
    let nanoseconds = estimates["median"]["point_estimate"].as_f64();
    let nanoseconds = nanoseconds.ok_or_else(|| Failure::Benchmark(HOST.into()))?;
    Ok(SIMULATED_S / (PER_NS * nanoseconds))
}

/// Reads the figures from the output of the board's benchmark.
fn board(said: &str) -> Option<Vec<Row>> {
    let line = |beginning: &str| said.lines().find(|line| line.starts_with(beginning));
    let quiet = line("position loop")?;
    let full = line("full load")?;
    let missed = said.lines().find(|line| line.contains("none missed"))?;
    let row = |what: &str, goal: &str, measured: String| Row {
        what: what.into(),
        goal: goal.into(),
        measured,
        command: BOARD.into(),
    };
    Some(vec![
        row(
            BOARD_LOOP,
            "≥ 10 × real time",
            format!(
                "{} ×, {} million instructions a second",
                before(quiet, " times real time")?,
                before(quiet, " million instructions")?
            ),
        ),
        row(
            "the same at full load: console busy both ways, everything switched on",
            "",
            format!("{} ×", before(full, " times real time")?),
        ),
        row(MISSED, "0", format!("0 of {}", missed.split_once(' ')?.0)),
    ])
}

/// The word before `words`.
fn before<'a>(text: &'a str, words: &str) -> Option<&'a str> {
    text.split_once(words)?.0.rsplit(' ').next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_of_the_board_are_read_from_the_output_of_its_benchmark() {
        let said = "position loop, quiet terminal: 54 s in 4.1 s of one core, 13.2 times real time, 108 million instructions a second\n\
                    full load: 60 s in 8.6 s of one core, 7.0 times real time, 110 million instructions a second\n\
                    1200000 control interrupts in 60 s at full load, none missed; the start varies by 0.143 µs\n";
        let measured: Vec<String> = board(said)
            .unwrap()
            .into_iter()
            .map(|row| row.measured)
            .collect();
        let expected = [
            "13.2 ×, 108 million instructions a second",
            "7.0 ×",
            "0 of 1200000",
        ];
        assert_eq!(measured, expected);
        assert_eq!(board("nothing of the kind"), None);
    }
}
