//! Tests of `paddle record` with a virtual board at the other end of a pseudo-terminal.

use std::io::{BufRead, BufReader, Lines};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use recording::{Drive, Recording};

const PADDLE: &str = env!("CARGO_BIN_EXE_paddle");

/// The image that `cargo fw` built, if there is one.
fn image(test: &str) -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent()?;
    let path = target.join("thumbv7em-none-eabihf/firmware/firmware");
    if !path.exists() {
        println!("skipped: {test}: no image; `cargo fw` builds it");
        return None;
    }
    Some(path)
}

/// Only one board runs at a time, because several boards could not run in real time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// A live virtual board. Dropping it ends its process.
struct Board {
    _alone: MutexGuard<'static, ()>,
    child: Child,
    _lines: Lines<BufReader<ChildStdout>>,
    port: String,
}

impl Board {
    fn start(image: &Path) -> Self {
        let alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let mut child = Command::new(PADDLE)
            .args(["board", "--plant", "nominal", "--elf"])
            .arg(image)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let port = lines
            .by_ref()
            .map(Result::unwrap)
            .find_map(|line| line.strip_prefix("serial port: ").map(str::to_owned))
            .expect("no port");
        Self {
            _alone: alone,
            child,
            _lines: lines,
            port,
        }
    }

    fn record(&self, out: &Path, runs: &[&str]) -> Command {
        let mut command = Command::new(PADDLE);
        command.args(["record", "--port", &self.port, "--out"]);
        command.arg(out);
        for run in runs {
            command.args(["--run", run]);
        }
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("record-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn said(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    format!("{out}{err}")
}

#[test]
fn experiments_are_recorded_and_the_board_is_handed_back_to_the_console() {
    let Some(image) = image("experiments_become_a_recording") else {
        return;
    };
    let board = Board::start(&image);
    let runs = ["step:10,0.4", "multisine:0.0036,2,1.5"];
    for out in ["first", "second"].map(folder) {
        let output = board.record(&out, &runs).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        let recording = Recording::read(&out).unwrap();
        let drives: Vec<_> = recording.runs.iter().map(|run| run.drive).collect();
        assert_eq!(drives, [Drive::ClosedLoop, Drive::OpenLoop]);
        assert!(recording.runs[1].duration_s() > 1.9);
        assert_eq!(recording.oddities, []);
        let session = std::fs::read_to_string(out.join("session.toml")).unwrap();
        for part in [
            "program = ",
            "torque:multisine:0.0036,2,1.5",
            "pid.kp = 0.05",
        ] {
            assert!(session.contains(part), "{session}");
        }
        // The folder contains a measurement.
        let again = board.record(&out, &runs).output().unwrap();
        assert_eq!(again.status.code(), Some(2));
        assert!(
            said(&again).contains("holds a recording"),
            "{}",
            said(&again)
        );
    }
}

#[test]
fn pulled_settings_can_be_changed_and_pushed_with_a_list_of_changes() {
    let Some(image) = image("settings_are_pulled") else {
        return;
    };
    let board = Board::start(&image);
    let file = folder("settings").with_extension("toml");
    let _ = std::fs::remove_file(&file);
    let settings = |arguments: &[&str]| {
        let mut command = Command::new(PADDLE);
        command.arg("settings").args(arguments);
        let output = command.args(["--port", &board.port]).arg(&file).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", said(&output));
        said(&output)
    };
    settings(&["pull"]);
    let pulled = std::fs::read_to_string(&file).unwrap();
    let changed = pulled.replace("pid.kp = 0.05 ", "pid.kp = 0.06 ");
    assert_ne!(pulled, changed);
    std::fs::write(&file, changed).unwrap();
    let planned = settings(&["push", "--dry-run"]);
    assert!(planned.contains("0.05 -> 0.06"), "{planned}");
    assert!(settings(&["push"]).contains("0.05 -> 0.06"));
    assert!(settings(&["push"]).contains("already"));
    assert!(!settings(&["pull"]).contains("->"));
}

#[test]
fn experiments_on_a_paddle_that_equals_its_model_name_nothing_confidently() {
    let Some(image) = image("experiments_on_a_paddle_as_it_is_modelled") else {
        return;
    };
    let board = Board::start(&image);
    let out = folder("experiment");
    let output = Command::new(PADDLE)
        .args(["experiment", "--port", &board.port, "--run", "step:10,0.5"])
        .args(["--run", "multisine:0.0036,2,3", "--seconds", "5", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let diagnosis = std::fs::read_to_string(out.join("diagnosis.json")).unwrap();
    let diagnosis: serde_json::Value = serde_json::from_str(&diagnosis).unwrap();
    // The recording depends on the instants at which the commands arrive. The gap of a model that is exact is near its floor, where
    // a name with a low confidence is possible.
    let [before, floor] =
        ["before", "nominal_floor"].map(|key| diagnosis["gap"][key].as_f64().unwrap());
    assert!(before < 2.0 * floor, "{before} {floor}: {}", said(&output));
    let effects = diagnosis["effects"].as_array().unwrap();
    let is_doubtful = |effect: &serde_json::Value| effect["confidence"].as_f64() < Some(0.7);
    assert!(effects.iter().all(is_doubtful), "{}", said(&output));
    for file in [
        "diagnosis.json",
        "report.html",
        "corrected.toml",
        "recording/recording.toml",
    ] {
        assert!(out.join(file).exists(), "{file}");
    }
}

#[test]
fn ctrl_c_disarms_and_keeps_the_complete_runs() {
    let Some(image) = image("ctrl_c_disarms_and_keeps") else {
        return;
    };
    let board = Board::start(&image);
    let out = folder("ended");
    let child = board
        .record(&out, &["step:10,0.3", "position:sine:10,1,60"])
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(14));
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("the paddle is disarmed"),
        "{}",
        said(&output)
    );
    assert_eq!(Recording::read(&out).unwrap().runs.len(), 1);
}

#[test]
fn an_invalid_port_and_an_invalid_experiment_are_reported() {
    let out = folder("none");
    for (arguments, part) in [
        (
            ["--port", "/dev/no-such-port", "--run", "step:10"],
            "check the name",
        ),
        (
            ["--port", "/dev/null", "--run", "hop:10"],
            "is no experiment",
        ),
    ] {
        let output = Command::new(PADDLE)
            .arg("record")
            .args(arguments)
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains(part), "{}", said(&output));
        assert!(!out.exists());
    }
}
