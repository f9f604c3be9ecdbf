//! Date, machine and commit of a measurement.

use std::fmt;
use std::fs;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::{Failure, output};

/// Number of digits of a printed commit.
const SHORT: usize = 12;
/// Ending of the commit of a program that was built with uncommitted changes.
const DIRTY: &str = "-dirty";

/// Date, machine and commit of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    date: String,
    machine: String,
    commit: String,
}

impl Origin {
    /// The origin with the present date, this machine and `commit`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the system does not provide the date.
    pub fn now(commit: &str) -> Result<Self, Failure> {
        Ok(Self {
            date: output(Command::new("date").arg("+%F"))?.trim().to_owned(),
            machine: machine(),
            commit: commit.to_owned(),
        })
    }

    /// The date, such as 2026-01-02.
    pub fn date(&self) -> &str {
        &self.date
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let commit = self.commit.get(..SHORT).unwrap_or(&self.commit);
        let changes = if self.commit.ends_with(DIRTY) {
            " with uncommitted changes"
        } else {
            ""
        };
        write!(
            f,
            "{}, commit {commit}{changes}, {}",
            self.date, self.machine
        )
    }
}

/// Name of the processor and number of its cores.
fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let mut lines = info.lines().filter_map(|line| line.split_once(':'));
    let model = lines.find(|(key, _)| key.trim() == "model name");
    let model = model.map_or("unknown processor", |(_, model)| model.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}, {cores} cores")
}
