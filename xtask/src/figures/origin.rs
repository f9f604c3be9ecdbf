//! When, where and of what something was measured.

use std::fmt;
use std::fs;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::{Failure, output};

/// Digits of a commit that a reader sees.
const SHORT: usize = 12;

/// When, where and of what something was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    date: String,
    machine: String,
    commit: String,
}

impl Origin {
    /// Today, on this machine, of a `commit`.
    ///
    /// # Errors
    /// [`Failure`] if the system does not say the date.
    pub fn now(commit: &str) -> Result<Self, Failure> {
        Ok(Self {
            date: output(Command::new("date").arg("+%F"))?.trim().to_owned(),
            machine: machine(),
            commit: commit.to_owned(),
        })
    }

    /// The day, as in 2026-01-02.
    pub fn date(&self) -> &str {
        &self.date
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let commit = self.commit.get(..SHORT).unwrap_or(&self.commit);
        write!(f, "{}, commit {commit}, {}", self.date, self.machine)
    }
}

/// The processor and how many of its cores there are.
fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let mut lines = info.lines().filter_map(|line| line.split_once(':'));
    let model = lines.find(|(key, _)| key.trim() == "model name");
    let model = model.map_or("unknown processor", |(_, model)| model.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}, {cores} cores")
}
