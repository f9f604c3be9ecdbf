//! Runs the program, and creates folders and recordings for the tests.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_paddle"));
    command.args(arguments);
    command
}

pub fn paddle(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

/// Creates an empty folder that only this test uses.
pub fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("first-use-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Creates a file in `folder` and returns its path as a command-line argument.
pub fn file(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The JSON that a successful command prints.
pub fn json(arguments: &[&str]) -> Value {
    let output = paddle(&[arguments, &["--json", "-"]].concat());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The single line with which a command refuses its input before any work.
pub fn refusal(arguments: &[&str]) -> String {
    let output = paddle(arguments);
    let line = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {line}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    assert_eq!(line.lines().count(), 1, "{arguments:?}: {line}");
    line.to_owned()
}

#[track_caller]
pub fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "`{part}` is not in: {said}");
    }
}

/// The bundled recording.
pub const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/demo");

/// Copies the bundled recording to `folder`.
pub fn recording(folder: &Path) -> String {
    let path = folder.join("recording");
    std::fs::create_dir_all(&path).unwrap();
    for name in ["recording.toml", "multisine.csv"] {
        std::fs::copy(Path::new(DEMO).join(name), path.join(name)).unwrap();
    }
    path.to_str().unwrap().to_owned()
}

/// Creates a named pipe that no other program uses.
pub fn pipe(folder: &Path) -> String {
    let path = folder.join("pipe");
    let made = Command::new("mkfifo").arg(&path).status().unwrap();
    assert!(made.success());
    path.to_str().unwrap().to_owned()
}
