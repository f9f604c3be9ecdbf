//! Output paths are checked before the work, and the result is printed even if its files cannot be written.

use crate::support::{
    DEMO, assert_says, command, file, folder, paddle, pipe, recording, refusal, text,
};
use std::process::Stdio;

#[test]
fn every_command_refuses_an_unwritable_target_before_its_work() {
    let out = folder("unwritable");
    let inside = out.to_str().unwrap();
    let nowhere = out.join("nowhere/file").to_str().unwrap().to_owned();
    let taken = file(&out, "taken", "");
    let below = format!("{taken}/below");
    let pipe = pipe(&out);
    // This recording does not exist, so a command that began its work would report it.
    let unread = "no-such-recording";
    for (arguments, named) in [
        (
            vec!["gap", "diagnose", unread, "--report", "/dev/full"],
            "--report /dev/full",
        ),
        (
            vec!["gap", "diagnose", unread, "--save-model", &nowhere],
            "--save-model",
        ),
        (
            vec!["gap", "diagnose", unread, "--json", &nowhere],
            "--json",
        ),
        (
            vec!["gap", "diagnose", unread, "--report", inside],
            "this is a folder",
        ),
        (
            vec!["gap", "diagnose", unread, "--json", ""],
            "the name is empty",
        ),
        (
            vec!["gap", "diagnose", unread, "--report", &pipe],
            "nobody reads",
        ),
        (
            vec!["gap", "diagnose", unread, "--report", &below],
            "--report",
        ),
        (
            vec!["gap", "diagnose", "--batch", unread, "--out", &below],
            "--out",
        ),
        (
            vec!["gap", "measure", unread, "--predictions", &below],
            "--predictions",
        ),
        (
            vec!["gap", "measure", unread, "--json", "/dev/full"],
            "--json /dev/full",
        ),
        (
            vec!["gap", "blind", "--cases", "1", "--out", &below],
            "--out",
        ),
        (
            vec!["sim", "step", "--plant", unread, "--out", &below],
            "--out",
        ),
        (
            vec!["sim", "sine", "--plant", unread, "--recording", &below],
            "--recording",
        ),
        (vec!["sim", "lab", "--out", &below], "--out"),
        (vec!["sim", "filter", "--out", &below], "--out"),
        (
            vec!["sim", "tune", "--plant", unread, "--out", &below],
            "--out",
        ),
        (
            vec!["sim", "zn", "--plant", unread, "--out", &below],
            "--out",
        ),
        (vec!["board", "--elf", unread, "--out", &below], "--out"),
        (
            vec!["board", "--elf", unread, "--recording", &below],
            "--recording",
        ),
        (vec!["reproduce", "--out", &below], "--out"),
        (vec!["demo", "--out", &below], "--out"),
        (vec!["effects", "--json", &nowhere], "--json"),
    ] {
        assert_says(&refusal(&arguments), &[named]);
    }
    let left: Vec<_> = out
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left.len(), 2, "the checks left something behind: {left:?}");
}

#[test]
fn one_path_for_two_results_is_refused() {
    let out = folder("twice");
    let page = out.join("page").to_str().unwrap().to_owned();
    let detour = out.join("./page").to_str().unwrap().to_owned();
    let plant = file(&out, "plant.toml", "[model]\nviscous = 1e-4\n");
    for arguments in [
        vec![
            "gap",
            "diagnose",
            DEMO,
            "--report",
            &page,
            "--save-model",
            &page,
        ],
        vec![
            "gap", "diagnose", DEMO, "--report", &page, "--json", &detour,
        ],
        vec!["sim", "step", "--out", &page, "--recording", &detour],
        vec!["gap", "measure", DEMO, "--model", &plant, "--json", &plant],
        vec!["sim", "step", "--plant", &plant, "--json", &plant],
    ] {
        assert_says(&refusal(&arguments), &["names the same"]);
    }
    // Several outputs may go to the same device.
    let output = paddle(&["effects", "backlash", "--json", "/dev/null"]);
    assert_eq!(output.status.code(), Some(0));
    let kept = std::fs::read_to_string(&plant).unwrap();
    assert_eq!(kept, "[model]\nviscous = 1e-4\n");
}

#[test]
fn a_result_never_overwrites_a_measurement() {
    let out = folder("measured");
    let measured = recording(&out);
    let files = ["recording.toml", "multisine.csv"].map(|name| format!("{measured}/{name}"));
    let before = files.clone().map(|file| std::fs::read(file).unwrap());
    for place in &files {
        assert_says(
            &refusal(&["gap", "measure", &measured, "--json", place]),
            &[&measured],
        );
        assert_says(
            &refusal(&["gap", "diagnose", &measured, "--report", place]),
            &[&measured],
        );
    }
    assert_says(
        &refusal(&["sim", "multisine", "--out", &measured]),
        &[&measured],
    );
    assert_eq!(files.map(|file| std::fs::read(file).unwrap()), before);
}

#[test]
fn the_result_is_printed_even_if_its_files_cannot_be_written() {
    let out = folder("gone");
    // The folder for the plots can be created, but a folder has the name of one of the plots.
    for name in ["step.svg", "step.csv"] {
        std::fs::create_dir_all(out.join("plots").join(name)).unwrap();
    }
    let plots = out.join("plots").to_str().unwrap().to_owned();
    let output = paddle(&["sim", "step", "--plant", "refit", "--out", &plots]);
    assert_eq!(output.status.code(), Some(2));
    assert_says(text(&output.stdout), &["overshoot", "settling"]);
    let complaints = text(&output.stderr);
    assert_says(complaints, &["step.svg", "step.csv"]);

    std::fs::create_dir_all(out.join("predictions/multisine.csv")).unwrap();
    let predictions = out.join("predictions").to_str().unwrap().to_owned();
    let output = paddle(&[
        "gap",
        "measure",
        DEMO,
        "--predictions",
        &predictions,
        "--json",
        "-",
    ]);
    assert_eq!(output.status.code(), Some(2));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(said["gap"]["before"].as_f64() > Some(0.0), "{said}");
    assert!(
        out.join("predictions/multisine.svg").is_file(),
        "the plot is lost as well"
    );
    assert_says(text(&output.stderr), &["multisine.csv"]);
}

#[test]
fn a_result_can_be_written_to_a_pipe_with_a_reader() {
    let out = folder("read-pipe");
    let pipe = pipe(&out);
    let reader = std::process::Command::new("cat")
        .arg(&pipe)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // The reader opens its end of the pipe after an unknown delay.
    std::thread::sleep(std::time::Duration::from_millis(300));
    let output = command(&["effects", "backlash", "--json", &pipe])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let read = reader.wait_with_output().unwrap().stdout;
    let read: serde_json::Value = serde_json::from_slice(&read).unwrap();
    assert_eq!(read["effects"][0]["name"], "backlash");
}
