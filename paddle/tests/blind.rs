//! Runs the blind check on a small fixed set of cases. The diagnosis receives only the recordings of an independent
//! simulator.

use std::process::Command;

/// Number of cases, and number of cases that may be judged wrong. This test checks that the diagnosis works. Its accuracy is
/// measured on the large set, which is run by hand.
const CASES: usize = 8;
const MOST_WRONG: usize = 3;

#[test]
fn most_cases_of_a_small_set_are_diagnosed_correctly() {
    let folder = std::env::temp_dir().join(format!("paddle-blind-{}", std::process::id()));
    let output = Command::new(env!("CARGO_BIN_EXE_paddle"))
        .args(["gap", "blind", "--seed", "5", "--patience", "300"])
        .args(["--cases", &CASES.to_string()])
        .arg("--out")
        .arg(&folder)
        .output()
        .expect("the binary runs");
    let lines = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{lines}");
    let judged = |word: &str| {
        lines
            .lines()
            .filter(|l| l.split_whitespace().nth(1) == Some(word))
            .count()
    };
    let (right, wrong, failed) = (judged("right"), judged("WRONG"), judged("failed"));
    assert_eq!(right + wrong, CASES, "{lines}");
    assert_eq!(failed, 0, "{lines}");
    assert!(wrong <= MOST_WRONG, "{lines}");
    std::fs::remove_dir_all(&folder).expect("the set can be removed");
}
