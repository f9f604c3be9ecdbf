//! Invalid input is refused with the name of the invalid item, and is never ignored.

use crate::support::{
    DEMO, assert_says, file, folder, json, paddle, pipe, recording, refusal, text,
};

#[test]
fn a_simulator_writes_no_recording_that_the_diagnosis_refuses() {
    let out = folder("unreadable");
    let [plots, measured] =
        ["plots", "recording"].map(|name| out.join(name).to_str().unwrap().to_owned());
    let plain = ["--out", &plots, "--recording", &measured];
    for (arguments, named) in [
        (&["sim", "step", "--horizon", "0"][..], "--horizon"),
        (&["sim", "step", "--horizon", "-1"], "--horizon"),
        (&["sim", "step", "--horizon", "NaN"], "--horizon"),
        (
            &["sim", "step", "--seconds", "0.3", "--horizon", "0.5"],
            "--horizon",
        ),
        (&["sim", "lab", "--seconds", "0.2"], "--seconds"),
        (
            &["board", "--elf", "none", "--seconds", "1", "--horizon", "2"],
            "--horizon",
        ),
        (
            &["board", "--elf", "none", "--seconds", "1", "--horizon", "0"],
            "--horizon",
        ),
    ] {
        let arguments = [arguments, &plain[..]].concat();
        assert_says(&refusal(&arguments), &[named]);
        assert!(!out.join("recording").exists(), "{arguments:?}");
    }
    // An error that appears only at the end is reported then, and the rest of the result is written.
    let still = [&["sim", "sine", "--torque", "--amplitude", "0"], &plain[..]].concat();
    let output = paddle(&still);
    assert_eq!(output.status.code(), Some(2));
    assert_says(text(&output.stdout), &["position", "sine.svg"]);
    assert_says(text(&output.stderr), &["`position` is", "in every row"]);
    assert!(!out.join("recording").exists());
    let good = [&["sim", "sine"], &plain[..]].concat();
    json(&good);
    assert_eq!(
        paddle(&["gap", "measure", &measured]).status.code(),
        Some(0)
    );
}

#[test]
fn a_missing_folder_of_lab_recordings_is_refused() {
    let out = folder("recorded");
    let empty = out.to_str().unwrap();
    for place in ["nowhere-at-all", empty] {
        assert_says(
            &refusal(&["reproduce", "--recorded", place]),
            &["--recorded", place],
        );
    }
}

#[test]
fn an_empty_model_is_refused() {
    let out = folder("says-nothing");
    let empty = file(&out, "empty.toml", "");
    let comment = file(&out, "comment.toml", "# later\n[model]\n");
    let settings = file(&out, "settings.toml", "[settings]\npid.kp = 0.05\n");
    for (place, named) in [
        ("/dev/null", "a device"),
        (&empty, "says nothing"),
        (&comment, "says nothing"),
        (&settings, "[settings]"),
    ] {
        assert_says(
            &refusal(&["gap", "measure", DEMO, "--model", place]),
            &[place, named],
        );
    }
    for place in ["/dev/null", &empty] {
        assert_says(&refusal(&["sim", "step", "--plant", place]), &[place]);
    }
}

#[test]
fn zero_counts_and_duplicates_are_refused() {
    for (arguments, named) in [
        (&["gap", "blind", "--jobs", "0"][..], "--jobs"),
        (&["gap", "blind", "--cases", "0"], "--cases"),
        (&["gap", "blind", "--patience", "0"], "--patience"),
        (&["gap", "blind", "--seed", "4,5,4"], "4 twice"),
        (&["gap", "blind", "--withhold", "stribek"], "stribek"),
        (
            &["sim", "step", "--with", "lag", "--with", "lag:time=0.01"],
            "'lag' is there twice",
        ),
        (
            &["sim", "step", "--with", "lag:time=0.01,time=0.02"],
            "time twice",
        ),
        (
            &["reproduce", "--with", "lag", "--with", "lag"],
            "'lag' is there twice",
        ),
    ] {
        assert_says(&refusal(arguments), &[named]);
    }
    let out = folder("twice-with");
    let twice = file(&out, "twice.toml", "with = [\"lag\", \"lag:time=0.01\"]\n");
    let once = file(&out, "once.toml", "with = [\"lag\"]\n");
    for arguments in [
        &["sim", "step", "--plant", &twice][..],
        &["gap", "measure", DEMO, "--model", &twice],
        &["sim", "step", "--plant", &once, "--with", "lag"],
    ] {
        assert_says(&refusal(arguments), &["'lag' is there twice"]);
    }
    let model = "format = 1\n[model]\ninertia = 5.755e-4\n[[effects]]\nname = \"viscous\"\nparameters = { coefficient = 4e-3 }\n\
                 [[effects]]\nname = \"viscous\"\nparameters = { coefficient = 5e-3 }\n";
    let model = file(&out, "model.toml", model);
    for arguments in [
        &["gap", "measure", DEMO, "--model", &model][..],
        &["sim", "step", "--plant", &model],
    ] {
        assert_says(
            &refusal(arguments),
            &["model.toml", "'viscous' is there twice"],
        );
    }
}

#[test]
fn impossible_device_parameters_are_refused_in_every_model_file() {
    let out = folder("no-device");
    for (wrong, name) in [
        ("coulomb = -0.01", "coulomb"),
        ("ratio = 0.0", "ratio"),
        ("lag = -1.0", "lag"),
        ("viscous = nan", "viscous"),
        ("travel = [0.5, -0.5]", "travel"),
        ("input_limit = 0.0", "input_limit"),
    ] {
        let differs = file(&out, "differs.toml", &format!("[model]\n{wrong}\n"));
        let whole = file(
            &out,
            "whole.toml",
            &format!("format = 1\n[model]\ninertia = 1e-3\n{wrong}\n"),
        );
        for place in [&differs, &whole] {
            let line = refusal(&["gap", "measure", DEMO, "--model", place]);
            assert_says(&line, &[place, &format!("`{name}` is"), "must be"]);
        }
    }
}

#[test]
fn text_is_refused_by_every_option_that_takes_a_number() {
    for (command, options) in [
        (
            &["sim", "step"][..],
            &[
                "--amplitude",
                "--offset",
                "--frequency",
                "--end-frequency",
                "--seconds",
                "--log-rate",
                "--horizon",
                "--kp",
                "--cutoff",
            ][..],
        ),
        (
            &["sim", "lab"],
            &["--amplitude", "--frequency", "--seconds"],
        ),
        (&["sim", "filter"], &["--kd", "--cutoff"]),
        (&["sim", "zn"], &["--amplitude"]),
        (
            &["sim", "tune"],
            &[
                "--amplitude",
                "--rise",
                "--friction-spread",
                "--phase-margin",
            ],
        ),
        (
            &["board", "--elf", "none"],
            &["--seconds", "--start", "--log-rate", "--horizon"],
        ),
    ] {
        for option in options {
            for value in ["NaN", "inf", "many"] {
                let line = refusal(&[command, &[option, value]].concat());
                assert_says(&line, &[option, "must be a number"]);
            }
        }
    }
    for option in ["--frequency", "--end-frequency", "--log-rate", "--seconds"] {
        assert_says(
            &refusal(&["sim", "sine", option, "0"]),
            &[option, "above 0"],
        );
    }
}

#[test]
fn a_script_that_is_longer_than_the_run_is_refused() {
    let out = folder("long-script");
    let script = file(&out, "script.txt", "0.1 zero hall\n3.0 step 10\n");
    let line = refusal(&[
        "board",
        "--elf",
        "none",
        "--script",
        &script,
        "--seconds",
        "1",
    ]);
    assert_says(&line, &["--seconds 1", "goes on to 3 s"]);
}

#[test]
fn a_pipe_without_a_writer_is_refused_by_every_option_that_reads() {
    let out = folder("pipe");
    let pipe = pipe(&out);
    for arguments in [
        &["gap", "measure", DEMO, "--model", &pipe][..],
        &["sim", "step", "--plant", &pipe],
        &["board", "--elf", &pipe, "--seconds", "1"],
        &["board", "--script", &pipe],
    ] {
        assert_says(&refusal(arguments), &[&pipe, "a pipe"]);
    }
    let measured = recording(&out);
    let csv = format!("{measured}/multisine.csv");
    std::fs::rename(&pipe, &csv).unwrap();
    assert_says(&refusal(&["gap", "diagnose", &measured]), &[&csv, "a pipe"]);
}

#[test]
fn an_unknown_unit_is_reported() {
    let out = folder("furlong");
    let measured = recording(&out);
    let manifest = format!("{measured}/recording.toml");
    let text = std::fs::read_to_string(&manifest).unwrap();
    let text = text.replacen("position = \"rad\"", "position = \"furlong\"", 1);
    assert_says(&text, &["furlong"]);
    std::fs::write(&manifest, text).unwrap();
    let warnings = json(&["gap", "measure", &measured])["warnings"].to_string();
    assert_says(&warnings, &["`furlong`", "no known unit of `position`"]);
}
