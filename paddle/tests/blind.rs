//! A small fixed set of the blind check: the diagnosis sees recordings of an independent reality and
//! nothing else.

use std::process::Command;

/// Cases of the set, and how many of them may be judged wrong: the large set, run by hand, is what says
/// how good the diagnosis is; this one says that it still works.
const CASES: usize = 8;
const MOST_WRONG: usize = 3;

#[test]
fn most_of_a_small_set_is_diagnosed_right() {
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
