//! Tests of the command line.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn paddle(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_paddle"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Creates an empty folder that only this test uses.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// JSON that a successful command prints. The command must print nothing else on either stream.
fn json(arguments: &[&str]) -> Value {
    let output = paddle(&[arguments, &["--json", "-"]].concat());
    assert_eq!(text(&output.stderr), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The single line on standard error of a command that refuses its input.
fn refusal(arguments: &[&str]) -> String {
    let output = paddle(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
    let line = text(&output.stderr);
    assert_eq!(line.lines().count(), 1, "{arguments:?}: {line}");
    line.to_owned()
}

#[test]
fn every_command_has_help_with_an_example() {
    let mut commands: Vec<&[&str]> = vec![
        &[],
        &["board"],
        &["demo"],
        &["effects"],
        &["reproduce"],
        &["gap", "measure"],
        &["gap", "diagnose"],
        &["gap", "import"],
        &["gap", "init"],
        &["gap", "export"],
        &["gap", "fleet"],
        &["sim", "filter"],
        &["sim", "lab"],
        &["sim", "zn"],
        &["sim", "tune"],
    ];
    let shapes = [
        "step",
        "sine",
        "square",
        "chirp",
        "multisine",
        "ramp",
        "triangle",
    ];
    let sims = shapes.map(|shape| ["sim", shape]);
    commands.extend(sims.iter().map(|sim| &sim[..]));
    for command in commands {
        let output = paddle(&[command, &["--help"]].concat());
        assert_eq!(output.status.code(), Some(0), "{command:?}");
        let help = text(&output.stdout);
        let example = format!("paddle {}", command.join(" "));
        let at = help
            .find("Example")
            .unwrap_or_else(|| panic!("{command:?}: {help}"));
        assert!(help[at..].contains(example.trim()), "{command:?}: {help}");
    }
}

#[test]
fn bad_input_is_refused_in_one_line_with_status_2() {
    let out = folder("refused");
    let file = |name: &str, content: &str| {
        let path = out.join(name);
        std::fs::write(&path, content).unwrap();
        path.display().to_string()
    };
    let no_toml = file("a.toml", "inertia = = 3");
    let wrong_table = file("b.toml", "[modle]\ninertia = 1.0");
    let wrong_key = file("c.toml", "[model]\ninertai = 1.0");
    let massless = file("d.toml", "[model]\ninertia = 0.0");
    let wrong_setting = file("e.toml", "[settings.pid]\nkp = -1");
    let wrong_effect = file("f.toml", "with = [\"stribek\"]");
    for (arguments, cause) in [
        (&["sim", "step", "--kp", "many"][..], "--kp"),
        (&["sim", "step", "--kp", "-1"], "pid.kp"),
        (&["sim", "step", "--set", "pid.kp"], "NAME=VALUE"),
        (&["sim", "step", "--set", "pid.kq=1"], "pid.kq"),
        (&["sim", "step", "--seconds", "-1"], "--seconds"),
        (&["sim", "step", "--seconds", "NaN"], "--seconds"),
        (&["sim", "sine", "--frequency", "0"], "frequency"),
        (&["sim", "step", "--with", "stribek"], "stribek"),
        (
            &["sim", "step", "--with", "stribeck:ratio=2"],
            "static_ratio",
        ),
        (&["sim", "step", "--plant", "nowhere.toml"], "nowhere.toml"),
        (&["sim", "step", "--plant", &no_toml], "a.toml"),
        (&["sim", "step", "--plant", &wrong_table], "modle"),
        (&["sim", "step", "--plant", &wrong_key], "inertai"),
        (&["sim", "step", "--plant", &massless], "inertia"),
        (&["sim", "step", "--plant", &wrong_setting], "pid.kp"),
        (&["sim", "step", "--plant", &wrong_effect], "stribek"),
        (&["sim", "lab", "--seconds", "0"], "--seconds"),
        (&["sim", "lab", "--amplitude", "NaN"], "--amplitude"),
        (&["sim", "zn", "--with", "coulomb:level=0.5"], "--amplitude"),
        (&["sim", "tune", "--rise", "0"], "--rise"),
        (
            &["sim", "tune", "--friction-spread", "100"],
            "--friction-spread",
        ),
        (&["sim", "steep"], "steep"),
        (&["gap", "measure"], "RECORDING"),
        (&["gap", "measure", "nowhere"], "nowhere"),
        (&["effects", "stribek"], "stribek"),
    ] {
        let line = refusal(&[arguments, &["--json", "-"]].concat());
        assert!(line.contains(cause), "{arguments:?}: {line}");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let out = folder("blocked").join("file");
    std::fs::write(&out, "").unwrap();
    let inside = out.join("inside").display().to_string();
    assert!(refusal(&["sim", "step", "--out", &inside]).contains(&inside));
}

#[test]
fn all_effects_are_listed_with_their_parameters() {
    let listed = json(&["effects"]);
    let listed = listed["effects"].as_array().unwrap();
    assert_eq!(listed.len(), host_sim::effects::KINDS.len());
    let output = paddle(&["effects"]);
    for (effect, kind) in listed.iter().zip(host_sim::effects::KINDS) {
        assert_eq!(effect["name"], kind.name);
        assert_eq!(
            effect["parameters"].as_array().unwrap().len(),
            kind.parameters.len()
        );
        assert!(text(&output.stdout).contains(kind.equation));
    }
}

#[test]
fn a_step_has_the_metrics_of_the_refitted_paddle() {
    let out = folder("step");
    let step = json(&[
        "sim",
        "step",
        "--plant",
        "refit",
        "--out",
        out.to_str().unwrap(),
    ]);
    let metric = |name: &str| step["metrics"][name].as_f64().unwrap();
    // The refit has an overshoot of 0.61°, a rise time of 38.9 ms and a settling time of 76.0 ms at a period of 351 µs.
    assert!((metric("overshoot_deg") - 0.61).abs() < 0.2, "{step}");
    assert!((metric("rise_ms") / 38.9 - 1.0).abs() < 0.1, "{step}");
    assert!((metric("settling_ms") / 76.0 - 1.0).abs() < 0.1, "{step}");

    let weak = json(&[
        "sim",
        "step",
        "--plant",
        "refit",
        "--kp",
        "0.01",
        "--kd",
        "0.0003",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(weak["metrics"]["rise_ms"].is_null(), "{weak}");
}

#[test]
fn json_in_a_file_leaves_the_text_on_standard_output() {
    let out = folder("json-file");
    let file = out.join("ramp.json");
    let output = paddle(&[
        "sim",
        "ramp",
        "--plant",
        "refit",
        "--out",
        out.to_str().unwrap(),
        "--json",
        file.to_str().unwrap(),
    ]);
    assert!(text(&output.stdout).contains("breaks away"));
    let ramp: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    // Breakaway torque of the refit: the forward level times the static ratio, plus the torques of gravity and motion over
    // 0.5°.
    let breakaway_nm = ramp["breakaway_nm"].as_f64().unwrap();
    assert!((0.63e-3..0.9e-3).contains(&breakaway_nm), "{ramp}");
}

#[test]
fn the_seed_determines_the_noise() {
    let out = folder("seed");
    let log = |seed: &str| {
        let arguments = [
            "sim",
            "sine",
            "--sensor",
            "hall",
            "--seconds",
            "1",
            "--seed",
            seed,
            "--out",
        ];
        json(&[&arguments[..], &[out.to_str().unwrap()]].concat());
        std::fs::read(out.join("sine.csv")).unwrap()
    };
    assert_eq!(log("1"), log("1"));
    assert_ne!(log("1"), log("2"));
}

#[test]
fn a_hidden_effect_opens_the_gap_and_its_model_closes_it() {
    let out = folder("hidden");
    let recording = out.join("recording");
    let measure = |with: &[&str], model: &[&str]| {
        let _ = std::fs::remove_dir_all(&recording);
        let plain = [
            "sim",
            "multisine",
            "--amplitude",
            "18",
            "--frequency",
            "0.5",
            "--out",
            out.to_str().unwrap(),
            "--recording",
            recording.to_str().unwrap(),
        ];
        json(&[&plain[..], with].concat());
        let gap = json(&[&["gap", "measure", recording.to_str().unwrap()], model].concat());
        gap["gap"]["before"].as_f64().unwrap() / gap["gap"]["floor"].as_f64().unwrap()
    };
    let file = out.join("true.toml");
    std::fs::write(&file, "with = [\"stribeck:static_ratio=1.8\"]\n").unwrap();
    let hidden = ["--with", "stribeck:static_ratio=1.8"];
    assert!(measure(&[], &[]) < 2.0);
    assert!(measure(&hidden, &[]) > 10.0);
    assert!(measure(&hidden, &["--model", file.to_str().unwrap()]) < 2.0);
}

#[test]
fn a_device_file_changes_model_and_settings() {
    let out = folder("device-file");
    let file = out.join("heavy.toml");
    std::fs::write(
        &file,
        "[model]\ninertia = 2.3e-3\n[settings]\npid.kd = 0.0\ncompensation.gravity = true\n",
    )
    .unwrap();
    let step = |extra: &[&str]| {
        let plain = [
            "sim",
            "step",
            "--seconds",
            "1",
            "--out",
            out.to_str().unwrap(),
        ];
        json(&[&plain[..], extra].concat())["metrics"]["rise_ms"]
            .as_f64()
            .unwrap()
    };
    let heavy = step(&["--plant", file.to_str().unwrap()]);
    // Four times the inertia doubles the time.
    let ratio = heavy / step(&["--kd", "0"]);
    assert!((1.6..2.4).contains(&ratio), "{ratio}");
}

#[test]
fn the_exported_predictions_have_the_reported_gap() {
    let out = folder("predictions");
    let recording = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo");
    let gap = json(&[
        "gap",
        "measure",
        recording.to_str().unwrap(),
        "--predictions",
        out.to_str().unwrap(),
    ]);
    assert_eq!(
        (&gap["format"], &gap["gap"]["unit"]),
        (&1.into(), &"rad".into())
    );
    let text = std::fs::read_to_string(out.join("multisine.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("time,measured,predicted"));
    let squares: Vec<f64> = lines
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            (cells[1] - cells[2]).powi(2)
        })
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let before = gap["gap"]["before"].as_f64().unwrap();
    assert!((rms / before - 1.0).abs() < 1e-4, "{rms} {before}");
}

#[test]
fn a_recording_is_never_overwritten() {
    let out = folder("kept");
    let manifest = out.join("recording.toml");
    std::fs::write(&manifest, "measured").unwrap();
    let kept = out.to_str().unwrap();
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/demo");
    for arguments in [
        [
            "sim",
            "step",
            "--out",
            env!("CARGO_TARGET_TMPDIR"),
            "--recording",
            kept,
        ],
        ["gap", "measure", demo, "--predictions", kept, "--json=-"],
    ] {
        assert!(refusal(&arguments).contains(kept));
    }
    assert_eq!(std::fs::read_to_string(manifest).unwrap(), "measured");
}

#[test]
fn an_error_in_a_recording_names_file_and_line() {
    let whole = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo");
    let out = folder("damaged");
    for name in ["recording.toml", "multisine.csv"] {
        std::fs::copy(whole.join(name), out.join(name)).unwrap();
    }
    let csv = out.join("multisine.csv");
    let rows = std::fs::read_to_string(&csv).unwrap();
    let damaged: Vec<_> = rows
        .lines()
        .enumerate()
        .map(|(i, row)| {
            if i == 100 {
                row.replacen(',', ",NaN", 1)
            } else {
                row.into()
            }
        })
        .collect();
    std::fs::write(&csv, damaged.join("\n")).unwrap();
    let line = refusal(&["gap", "measure", out.to_str().unwrap()]);
    assert!(
        line.contains("multisine.csv") && line.contains("101"),
        "{line}"
    );
}

#[test]
fn the_demo_writes_the_files_that_it_names_and_closes_a_gap() {
    let out = folder("demo");
    let output = paddle(&["demo", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    for what in ["overshoot", "rise", "settling", "gap", "floor"] {
        assert!(said.contains(what), "{said}");
    }
    let demo = json(&["demo", "--out", out.to_str().unwrap()]);
    assert!(
        demo["gap"]["before"].as_f64() > demo["gap"]["floor"].as_f64().map(|floor| 10.0 * floor)
    );
    let diagnosis = &demo["diagnosis"];
    assert_eq!(diagnosis["verdict"], "explained");
    assert_eq!(diagnosis["effects"][0]["name"], "stribeck");
    let files = demo["files"].as_array().unwrap().iter();
    let files: Vec<_> = files
        .chain(demo["step"]["files"].as_array().unwrap())
        .collect();
    assert_eq!(
        files
            .iter()
            .filter(|file| file.as_str().unwrap().ends_with(".svg"))
            .count(),
        2
    );
    for file in files {
        let content = std::fs::read_to_string(file.as_str().unwrap()).unwrap();
        assert!(said.contains(file.as_str().unwrap()) && !content.is_empty());
        if file.as_str().unwrap().ends_with(".html") {
            assert!(content.starts_with("<!DOCTYPE html>"));
        }
        if file.as_str().unwrap().ends_with(".svg") {
            assert!(content.starts_with("<svg") && content.trim_end().ends_with("</svg>"));
        }
    }
}

#[test]
fn the_report_is_reproduced_on_the_refit_and_not_on_a_heavier_plant() {
    let out = folder("reproduce");
    let check = |with: &[&str]| {
        let plain = [
            "reproduce",
            "--check",
            "--out",
            out.to_str().unwrap(),
            "--json",
            "-",
        ];
        let output = paddle(&[&plain[..], with].concat());
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), said)
    };
    let (status, said) = check(&[]);
    assert_eq!(status, Some(0), "{said:#}");
    let rows = said["rows"].as_array().unwrap();
    for row in rows {
        for key in ["name", "report", "ours", "unit", "bar", "ok"] {
            assert!(row.get(key).is_some(), "{key}: {row}");
        }
        assert_eq!(row["bar"].is_null(), row["ok"].is_null(), "{row}");
    }
    assert!(rows.iter().filter(|row| row["ok"] == true).count() >= 15);
    for figure in [3, 4, 6, 7, 8, 9] {
        assert!(out.join(format!("figure-{figure}.svg")).is_file());
    }

    let (status, said) = check(&["--with", "inertia:inertia=6.072e-4"]);
    assert_eq!(status, Some(1), "10 % more inertia: {said:#}");
    let period = |row: &&Value| row["name"].as_str().unwrap().contains("Tu");
    let rows = said["rows"].as_array().unwrap();
    assert_eq!(rows.iter().find(period).unwrap()["ok"], false);
}

#[test]
fn ziegler_nichols_on_the_firmware_finds_nearly_the_ultimate_gain_of_the_lab() {
    let out = folder("zn");
    let arguments = [
        "sim",
        "zn",
        "--plant",
        "refit",
        "--current-loop",
        "--out",
        out.to_str().unwrap(),
    ];
    let found = json(&arguments);
    // The lab found 0.05 N m/° and 86.7 ms by hand, at half the sampling rate.
    assert!(
        (found["ku_nm_per_deg"].as_f64().unwrap() / 0.05 - 1.0).abs() < 0.1,
        "{found}"
    );
    assert!(
        (found["tu_ms"].as_f64().unwrap() / 86.7 - 1.0).abs() < 0.1,
        "{found}"
    );
    for line in found["console"].as_array().unwrap() {
        let words: Vec<_> = line.as_str().unwrap().split(' ').collect();
        let mut settings = haptic_paddle::settings::Settings::default();
        assert!(
            words[0] == "set" && settings.set(words[1], words[2]).is_ok(),
            "{line}"
        );
    }
}

#[test]
fn tuned_gains_meet_the_reports_specification_when_typed() {
    let out = folder("tune");
    let out = out.to_str().unwrap();
    let tuned = json(&["sim", "tune", "--plant", "refit", "--out", out]);
    assert_eq!(tuned["meets"], true, "{tuned}");
    assert_eq!(tuned["cases"].as_array().unwrap().len(), 5);
    let typed = tuned["console"].as_array().unwrap().iter();
    let typed: Vec<_> = typed
        .map(|line| {
            line.as_str()
                .unwrap()
                .strip_prefix("set ")
                .unwrap()
                .replacen(' ', "=", 1)
        })
        .collect();
    let mut step = vec!["sim", "step", "--plant", "refit", "--out", out];
    for setting in &typed {
        step.extend(["--set", setting]);
    }
    let metrics = &json(&step)["metrics"];
    let metric = |name: &str| metrics[name].as_f64().unwrap();
    assert!(
        metric("overshoot_deg") <= 2.5 && metric("rise_ms") <= 100.0,
        "{metrics}"
    );
    assert!(metric("settling_ms") <= 350.0, "{metrics}");
}

#[test]
fn a_specification_that_cannot_be_met_ends_with_status_1_and_lists_the_missed_bounds() {
    let out = folder("tune-out-of-reach");
    let out = out.to_str().unwrap();
    let output = paddle(&["sim", "tune", "--rise", "10", "--out", out]);
    assert_eq!(output.status.code(), Some(1));
    let rise = text(&output.stdout)
        .lines()
        .find(|line| line.starts_with("rise"));
    assert!(rise.unwrap().contains("MISSED"));
}

#[test]
fn a_saved_model_is_a_plant_without_effects_of_one_time() {
    let out = folder("saved-model");
    let file = out.join("corrected.toml");
    let model = "format = 1\n[model]\ninertia = 1.2e-3\nratio = 15.0\n[[effects]]\nname = \"viscous\"\n\
                 parameters = { coefficient = 4e-3 }\n[[moments]]\nrecording = \"Monday\"\nfingerprint = \"0\"\n\
                 name = \"lost_counts\"\nparameters = { time = 0.1, jump = 0.1, share = 0.0, speed = 0.0 }\n";
    std::fs::write(&file, model).unwrap();
    let [out, file] = [&out, &file].map(|path| path.to_str().unwrap());
    let output = paddle(&["sim", "tune", "--plant", file, "--out", out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(
        said.starts_with("warning: lost_counts is bound") && said.contains("set kp"),
        "{said}"
    );
}

#[test]
fn the_filter_lowers_the_noise_and_allows_a_larger_derivative_gain() {
    let out = folder("filter");
    let filter = json(&["sim", "filter", "--out", out.to_str().unwrap()]);
    let value = |case: usize, name: &str| filter["cases"][case][name].as_f64().unwrap();
    for [without, with] in [[0, 1], [2, 3]] {
        assert!(value(with, "torque_noise_nm") < 0.5 * value(without, "torque_noise_nm"));
        let largest = "largest_stable_kd_nm_s_per_deg";
        assert!(value(with, largest) > 2.0 * value(without, largest));
    }
}

/// Simulates a short recording with the effects `with`, in a folder below `out`.
fn recorded(out: &Path, name: &str, with: &[&str]) -> PathBuf {
    let recording = out.join(name);
    let plain = [
        "sim",
        "multisine",
        "--amplitude",
        "15",
        "--frequency",
        "0.5",
        "--log-rate",
        "950",
        "--out",
        out.to_str().unwrap(),
        "--recording",
        recording.to_str().unwrap(),
    ];
    json(&[&plain[..], with].concat());
    recording
}

#[test]
fn a_diagnosis_has_the_keys_of_the_format_and_writes_the_requested_files() {
    let out = folder("diagnosis");
    let recording = recorded(&out, "hidden", &["--with", "stribeck:static_ratio=1.8"]);
    let [model, page] = ["corrected.toml", "report.html"].map(|name| out.join(name));
    let output = paddle(&[
        "gap",
        "diagnose",
        recording.to_str().unwrap(),
        "--json",
        "-",
        "--save-model",
        model.to_str().unwrap(),
        "--report",
        page.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0));
    let diagnosis: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys = |value: &Value| {
        let mut keys: Vec<_> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys.join(" ")
    };
    assert_eq!(
        keys(&diagnosis),
        "candidates effects elapsed_s format gap missing_torque next_experiment numbers provenance verdict warnings where"
    );
    assert_eq!(
        keys(&diagnosis["gap"]),
        "after before coasting floor floor_of nominal_floor shrink shrink_interval standing unit"
    );
    assert_eq!(
        keys(&diagnosis["effects"][0]),
        "basis channel confidence name not_separable_from parameters shrink shrink_interval"
    );
    assert_eq!(diagnosis["effects"][0]["name"], "stribeck");
    assert_eq!(keys(&diagnosis["candidates"][0]), "after name why_not");

    let measured = ["gap", "measure", recording.to_str().unwrap()];
    let stated = json(&measured)["gap"].clone();
    let with_model = [&measured[..], &["--model", model.to_str().unwrap()]].concat();
    let saved = json(&with_model)["gap"].clone();
    let [nominal, corrected] = [&stated, &saved].map(|gap| gap["before"].as_f64().unwrap());
    assert_eq!(diagnosis["gap"]["before"], nominal);
    assert_eq!(
        (&stated["floor_of"], &saved["floor_of"]),
        (&"nominal_model".into(), &"model_given".into())
    );
    assert_eq!(diagnosis["gap"]["nominal_floor"], stated["floor"]);
    assert_eq!(diagnosis["gap"]["floor_of"], "corrected_model");
    assert_eq!(diagnosis["gap"]["floor"], saved["floor"]);
    assert!(corrected < 0.2 * nominal, "{corrected} of {nominal}");
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Static friction"));
}

#[test]
fn an_unexplained_gap_has_the_same_floor_in_measure_and_diagnose() {
    let out = folder("one-floor");
    let recording = recorded(&out, "hidden", &["--with", "stribeck:static_ratio=1.8"]);
    let recording = recording.to_str().unwrap();
    let kinds = json(&["effects"]);
    let names = kinds["effects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|kind| &kind["name"]);
    let without = names.flat_map(|name| ["--without", name.as_str().unwrap()]);
    let diagnose = ["gap", "diagnose", recording].into_iter().chain(without);
    let diagnosis = json(&diagnose.collect::<Vec<_>>());
    assert_eq!(diagnosis["verdict"], "unexplained");
    let gap = &diagnosis["gap"];
    let measured = &json(&["gap", "measure", recording])["gap"];
    for key in ["before", "floor", "floor_of", "unit"] {
        assert_eq!(gap[key], measured[key], "{key}: {gap} and {measured}");
    }
    assert_eq!(gap["nominal_floor"], gap["floor"]);
}

#[test]
fn a_result_states_the_program_version_and_the_input_checksums() {
    let out = folder("provenance");
    let recording = recorded(&out, "plain", &[]);
    let csv = std::fs::read_dir(&recording).unwrap().count();
    let page = out.join("report.html");
    let [recording, page] = [&recording, &page].map(|path| path.to_str().unwrap());
    let calls = [
        vec!["gap", "diagnose", recording, "--report", page],
        vec!["gap", "measure", recording],
    ];
    let model = out.join("plant.toml");
    std::fs::write(&model, "[model]\ninertia = 5.755e-4\n").unwrap();
    for call in &calls {
        let provenance = json(call)["provenance"].clone();
        assert_eq!(provenance["version"], env!("CARGO_PKG_VERSION"));
        let commit = provenance["commit"].as_str().unwrap();
        let hash = commit.trim_end_matches("-dirty");
        let is_hash = hash.len() == 40 && hash.bytes().all(|b| b.is_ascii_hexdigit());
        assert!(is_hash || commit == "unknown", "{commit}");
        let command = provenance["command"].as_str().unwrap();
        assert!(command.starts_with("paddle gap "), "{command}");
        assert!(command.contains(recording), "{command}");
        let time = provenance["time"].as_str().unwrap();
        assert!(
            time.starts_with("20") && time.ends_with('Z') && time.len() == 20,
            "{time}"
        );
        let files = provenance["files"].as_array().unwrap();
        assert_eq!(files.len(), csv, "{files:?}");
        assert_eq!(files[0]["file"], "recording.toml");
        for file in files {
            let sum = file["sha256"].as_str().unwrap();
            assert!(
                sum.len() == 64 && sum.bytes().all(|b| b.is_ascii_hexdigit()),
                "{sum}"
            );
        }
    }
    // Computed with `sha256sum`.
    let with_model = [&calls[1][..], &["--model", model.to_str().unwrap()]].concat();
    let files = &json(&with_model)["provenance"]["files"];
    let sum = "57c9255453cd4883fb09e3a07c765c784acd7f0737fbea920174fdba22adfcf0";
    assert_eq!(files.as_array().unwrap().last().unwrap()["sha256"], sum);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("SHA-256") && page.contains("recording.toml"));
}

#[test]
fn the_diagnosis_finds_that_the_dry_friction_of_the_labs_simulink_model_has_no_effect() {
    let out = folder("lab");
    let recording = out.join("recording");
    let [out, recording] = [&out, &recording].map(|path| path.to_str().unwrap());
    let lab = json(&["sim", "lab", "--out", out, "--recording", recording]);
    assert_eq!(lab["friction_acts"], false);
    let diagnosis = json(&["gap", "diagnose", recording]);
    assert_eq!(diagnosis["verdict"], "explained");
    let effect = &diagnosis["effects"][0];
    assert_eq!(effect["name"], "coulomb");
    // The model was meant to have a dry friction of 15 mN m at the joint.
    assert!(effect["parameters"]["level"]["value"].as_f64().unwrap() < 1e-3);
}

#[test]
fn an_excluded_effect_is_not_named() {
    let out = folder("without");
    let recording = recorded(&out, "hidden", &["--with", "viscous:coefficient=4e-3"]);
    let diagnosis = json(&[
        "gap",
        "diagnose",
        recording.to_str().unwrap(),
        "--without",
        "viscous",
    ]);
    assert!(!diagnosis.to_string().contains("\"viscous\""));
}

#[test]
fn a_model_with_an_effect_of_one_time_warns_on_another_recording() {
    let out = folder("moment");
    let recording = recorded(&out, "hidden", &[]);
    let file = out.join("model.toml");
    let text = "format = 1\n[model]\ninertia = 5.755e-4\n[[moments]]\nrecording = \"Monday\"\nfingerprint = \"0\"\n\
                name = \"lost_counts\"\nparameters = { time = 0.5, jump = 0.1, share = 0.0, speed = 0.0 }\n";
    std::fs::write(&file, text).unwrap();
    let measured = json(&[
        "gap",
        "measure",
        recording.to_str().unwrap(),
        "--model",
        file.to_str().unwrap(),
    ]);
    let warnings = measured["warnings"].as_array().unwrap();
    let warning = warnings.last().unwrap().as_str().unwrap();
    assert!(warning.contains("lost_counts") && warning.contains("Monday"));
    std::fs::write(&file, text.replace("lost_counts", "lost_count")).unwrap();
    let arguments = [
        "gap",
        "measure",
        recording.to_str().unwrap(),
        "--model",
        file.to_str().unwrap(),
    ];
    let line = refusal(&arguments);
    assert!(
        line.contains("model.toml") && line.contains("lost_count"),
        "{line}"
    );
}

#[test]
fn a_batch_continues_after_a_failure_and_a_second_call_does_only_the_missing_recordings() {
    let out = folder("batch");
    let cases = out.join("cases");
    std::fs::create_dir_all(cases.join("broken")).unwrap();
    std::fs::write(cases.join("broken/recording.toml"), "format = 1\n").unwrap();
    let hidden = recorded(
        &cases,
        "tuesday/hidden",
        &["--with", "stribeck:static_ratio=1.8"],
    );
    recorded(&cases, "wednesday", &[]);
    let results = out.join("results");
    let lines = || -> Vec<Value> {
        let output = paddle(&[
            "gap",
            "diagnose",
            "--batch",
            "nowhere",
            cases.to_str().unwrap(),
            "--out",
            results.to_str().unwrap(),
            "--json",
            "-",
        ]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr)
                .lines()
                .last()
                .unwrap()
                .contains("2 of 4")
        );
        let lines = text(&output.stdout).lines();
        lines
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    };
    let first = lines();
    assert_eq!(first.len(), 4);
    assert_eq!(first[0]["recording"], "nowhere");
    assert!(
        first[1]["error"]
            .as_str()
            .unwrap()
            .contains("recording.toml")
    );
    assert_eq!(first[2]["effects"][0]["name"], "stribeck");
    assert!(first[3]["verdict"].is_string());
    for line in &first[2..] {
        let recording = line["recording"].as_str().unwrap();
        let place = results.join(&recording[1..]);
        for extension in ["json", "html", "toml"] {
            assert!(
                place.with_extension(extension).is_file(),
                "{}",
                place.display()
            );
        }
    }
    // A second diagnosis would change the measured time in the output.
    assert_eq!(lines(), first);

    let touched = std::fs::read(hidden.join("recording.toml")).unwrap();
    std::fs::write(hidden.join("recording.toml"), touched).unwrap();
    let again = lines();
    assert_eq!(again[3], first[3]);
    assert_ne!(again[2]["elapsed_s"], first[2]["elapsed_s"]);
}

#[cfg(unix)]
#[test]
fn a_batch_follows_links_without_looping() {
    use std::os::unix::fs::symlink;
    let out = folder("linked-batch");
    let elsewhere = out.join("elsewhere");
    let cases = out.join("cases");
    std::fs::create_dir_all(&elsewhere).unwrap();
    std::fs::create_dir_all(&cases).unwrap();
    std::fs::write(elsewhere.join("recording.toml"), "format = 1\n").unwrap();
    symlink(&elsewhere, cases.join("link")).unwrap();
    symlink(&cases, cases.join("circle")).unwrap();
    let output = paddle(&["gap", "diagnose", "--batch", cases.to_str().unwrap()]);
    let said = text(&output.stderr);
    assert!(said.contains("1 of 1 recordings"), "{said}");
}

#[test]
fn a_batch_without_recordings_is_refused() {
    let out = folder("empty-batch");
    let line = refusal(&["gap", "diagnose", "--batch", out.to_str().unwrap()]);
    assert!(line.contains("no recording") && line.contains("recording.toml"));
    assert!(refusal(&["gap", "diagnose"]).contains("RECORDING"));
    assert!(refusal(&["gap", "diagnose", "nowhere", "--without", "stribek"]).contains("stribek"));
}

#[test]
fn a_board_that_cannot_run_reports_the_cause() {
    let folder = folder("board");
    let script = folder.join("script.txt");
    std::fs::write(&script, "0.2 arm\n0.1 zero\n").unwrap();
    let script = script.to_str().unwrap();
    for (arguments, named) in [
        (vec!["--script", script], "line 2"),
        (vec!["--script", "nowhere.txt"], "nowhere.txt"),
        (
            vec!["--seconds", "1", "--elf", "nowhere.elf"],
            "nowhere.elf",
        ),
        (vec!["--seconds", "1", "--elf", script], "32-bit ELF"),
        (vec!["--seconds", "1", "--wire", "blue"], "motor-swapped"),
        (vec!["--seconds", "1", "--log-rate", "0"], "--log-rate"),
        (vec!["--seconds", "1", "--start", "120"], "--start"),
        (
            vec!["--seconds", "1", "--plant", "nowhere.toml"],
            "nowhere.toml",
        ),
    ] {
        let line = refusal(&[&["board"], &arguments[..]].concat());
        assert!(line.contains(named), "{arguments:?}: {line}");
    }
}
