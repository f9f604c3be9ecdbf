//! Tests of a live board that the user interrupts, and of the build of its firmware.

use crate::support::{assert_says, command, file, folder, text};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// The image that `cargo fw` built, if there is one.
fn image(test: &str) -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent()?;
    let path = target.join("thumbv7em-none-eabihf/firmware/firmware");
    if !path.exists() {
        println!(
            "skipped: {test}: no image at {}; `cargo fw` builds it",
            path.display()
        );
        return None;
    }
    Some(path)
}

#[test]
fn a_live_board_that_is_interrupted_writes_recording_and_trace_and_exits_with_0() {
    let Some(image) = image("ended_board") else {
        return;
    };
    for signal in ["INT", "TERM", "HUP"] {
        let out = folder(&format!("ended-{signal}"));
        let [trace, recording] = ["trace", "recording"].map(|name| out.join(name));
        let [elf, to, into] = [&image, &trace, &recording].map(|path| path.to_str().unwrap());
        let mut child = command(&[
            "board",
            "--elf",
            elf,
            "--out",
            to,
            "--recording",
            into,
            "--start",
            "5",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let port = lines.find(|line| line.as_ref().unwrap().starts_with("serial port: "));
        assert!(port.is_some());
        // Log entries appear once the firmware has booted, 70 ms after power-on in simulated time.
        assert!(lines.any(|line| line.unwrap().starts_with("log ")));
        std::thread::sleep(Duration::from_millis(300));
        let id = child.id().to_string();
        assert!(
            Command::new("kill")
                .args([&format!("-{signal}"), &id])
                .status()
                .unwrap()
                .success()
        );
        let said: Vec<String> = lines.map(Result::unwrap).collect();
        let output = child.wait_with_output().unwrap();
        let complaints = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{signal}: {complaints}");
        assert_says(&said.join("\n"), &["recording in", "trace.csv"]);
        let rows = |path: PathBuf| std::fs::read_to_string(path).unwrap().lines().count();
        for file in [trace.join("trace.csv"), recording.join("board.csv")] {
            let (file, rows) = (file.display().to_string(), rows(file));
            assert!(rows > 50, "{signal}: {rows} rows in {file}");
        }
        assert!(recording.join("recording.toml").is_file(), "{signal}");
        let console = std::fs::read_to_string(trace.join("console.txt")).unwrap();
        assert_says(&console, &["haptic paddle"]);
    }
}

#[test]
fn the_compiler_target_is_announced_and_installed_before_the_firmware_is_built() {
    let out = folder("no-target");
    let library = out.join("library");
    std::fs::create_dir_all(&library).unwrap();
    // The test provides a compiler without the target, a rustup that has the target, and a cargo that needs it.
    let program = |name: &str, body: String| {
        let path = file(&out, name, &format!("#!/bin/sh\n{body}\n"));
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).unwrap();
        path
    };
    let library = library.display();
    program("rustc", format!("echo {library}"));
    program(
        "rustup",
        format!(
            "echo \"$@\" > {}/asked; touch {library}/libcore-0.rlib",
            out.display()
        ),
    );
    let built = out.join("target/thumbv7em-none-eabihf/firmware");
    let cargo = program(
        "cargo",
        format!(
            "test -e {library}/libcore-0.rlib && mkdir -p {0} && echo built > {0}/firmware",
            built.display()
        ),
    );
    let path = format!("{}:{}", out.display(), std::env::var("PATH").unwrap());
    let output = command(&["board", "--seconds", "0.1"])
        .env("PATH", path)
        .env("CARGO", cargo)
        .env("CARGO_TARGET_DIR", out.join("target"))
        .output()
        .unwrap();
    let said = text(&output.stderr);
    let asked = std::fs::read_to_string(out.join("asked")).unwrap_or_default();
    assert_eq!(asked.trim(), "target add thumbv7em-none-eabihf", "{said}");
    assert_says(
        said,
        &[
            "adding the compiler's target",
            "takes",
            "building the firmware",
            "minute",
        ],
    );
    // The file that this cargo built is not an image; the last line of the output says so.
    assert_says(said, &["firmware/firmware", "32-bit ELF"]);
}
