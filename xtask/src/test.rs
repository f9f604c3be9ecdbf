//! `cargo xtask test`: every check that a change must pass.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::{Failure, cargo, shown};

/// Tests that may be skipped, each with the requirement that a fresh clone may lack.
const MAY_SKIP: &[(&str, &str)] = &[
    ("shared_data", "real recordings beside the project"),
    (
        "python_formats",
        "Python with the packages that write the formats of other programs",
    ),
    (
        "image_figures",
        "the compiler that the figures of the firmware image name",
    ),
    ("python_package", "Python with numpy and maturin"),
    ("mujoco", "Python with numpy and mujoco"),
];

/// Prints that a check of [`MAY_SKIP`] is skipped.
pub fn say_skipped(name: &str, why: &str) {
    debug_assert!(MAY_SKIP.iter().any(|(stated, _)| *stated == name), "{name}");
    println!("skipped: {name}: {why}");
}

/// Runs formatting, lints, the firmware image, all tests and the Python checks in this order. Stops at the first failure.
pub fn run() -> Result<(), Failure> {
    crate::run(&mut cargo(&["fmt", "--all", "--check"]))?;
    crate::run(&mut cargo(&[
        "clippy",
        "--workspace",
        "--all-targets",
        "--quiet",
        "--",
        "--deny",
        "warnings",
    ]))?;
    crate::firmware::check()?;
    host_tests()?;
    crate::python::checks()?;
    // The check uses the command line that the tests have built.
    crate::figures::check_built()
}

/// Runs all tests of all crates, with doc tests. Reads the output of passing tests for skip messages.
fn host_tests() -> Result<(), Failure> {
    let mut command = cargo(&[
        "test",
        "--workspace",
        "--no-fail-fast",
        "--",
        "--show-output",
    ]);
    let cannot_run = |source| Failure::Spawn {
        command: "cargo test".into(),
        source,
    };
    let mut child = command.stdout(Stdio::piped()).spawn().map_err(cannot_run)?;
    let mut log = TestLog::default();
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).split(b'\n') {
            let line = line.map_err(cannot_run)?;
            let line = String::from_utf8_lossy(&line);
            if log.read(&line) {
                println!("{line}");
            }
        }
    }
    if !child.wait().map_err(cannot_run)?.success() {
        return Err(Failure::Step(shown(&command)));
    }
    let unstated = log.unstated(MAY_SKIP);
    if unstated.is_empty() {
        Ok(())
    } else {
        Err(Failure::Skipped(unstated))
    }
}

/// Collects the skipped tests from the test output.
///
/// A test is skipped if libtest calls it `ignored`, or if it printed a line
/// `skipped: NAME: REASON` because something that it needs is not there.
#[derive(Debug, Default)]
struct TestLog {
    skipped: Vec<String>,
    in_passing_output: bool,
}

impl TestLog {
    /// Reads the next line. Returns true if the line should be printed.
    fn read(&mut self, line: &str) -> bool {
        if line == "successes:" {
            self.in_passing_output = true;
        } else if line == "failures:" || line.starts_with("test result:") {
            self.in_passing_output = false;
        }
        if let Some(rest) = line.strip_prefix("skipped: ") {
            // A line without a test name counts as an unstated skip.
            let name = rest.split_once(": ").map_or(rest, |(name, _reason)| name);
            self.skipped.push(name.to_owned());
            return true;
        }
        if let Some((name, outcome)) = line
            .strip_prefix("test ")
            .and_then(|rest| rest.rsplit_once(" ... "))
            && outcome.starts_with("ignored")
        {
            self.skipped.push(name.to_owned());
        }
        !self.in_passing_output
    }

    /// The skipped tests that `may_skip` does not list.
    fn unstated(&self, may_skip: &[(&str, &str)]) -> Vec<String> {
        self.skipped
            .iter()
            .filter(|name| !may_skip.iter().any(|(stated, _)| stated == name))
            .cloned()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::TestLog;

    const LOG: &str = "\
running 4 tests
test sine::keeps_phase ... ok
test sine::slow ... ignored, takes an hour
test real_data ... ok
test src/lib.rs - (line 3) ... ignored

successes:

---- real_data stdout ----
chatter
skipped: real_data: no recordings beside this repository

successes:
    real_data
    sine::keeps_phase

test result: ok. 2 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out";

    #[test]
    fn a_skip_without_a_test_name_is_printed_and_unstated() {
        let mut log = TestLog::default();
        assert!(log.read("skipped: no recordings here"));
        assert_eq!(log.unstated(&[]), ["no recordings here"]);
    }

    #[test]
    fn ignored_tests_and_skip_lines_are_found() {
        let mut log = TestLog::default();
        let shown: Vec<_> = LOG.lines().filter(|line| log.read(line)).collect();
        assert_eq!(
            log.unstated(&[]),
            ["sine::slow", "src/lib.rs - (line 3)", "real_data"]
        );
        assert_eq!(
            log.unstated(&[("real_data", "recordings"), ("sine::slow", "time")]),
            ["src/lib.rs - (line 3)"]
        );
        assert!(!shown.contains(&"chatter"));
        assert!(
            shown
                .iter()
                .any(|line| line.starts_with("skipped: real_data"))
        );
        assert!(
            shown
                .last()
                .is_some_and(|line| line.starts_with("test result: ok. 2 passed"))
        );
    }
}
