//! Every kind of bad input gives one line with the file, the row and the remedy.

use std::fmt::Write;

use crate::folder::Folder;
use proptest::prelude::*;

const MANIFEST: &str = "format = 1
title = \"test\"
horizon = 0.1
[model]
inertia = 5e-4
coulomb = 0.01
gravity = 0.0146
ratio = 15.0
travel = [-0.6, 0.6]
[sensor.position]
resolution = 1e-4
[[runs]]
file = \"a.csv\"
drive = \"open-loop\"
";

/// A CSV file of one second of a paddle at 1 kHz. `edit` changes every sample.
fn csv(edit: impl Fn(&mut [f64; 3])) -> String {
    let mut text = String::from("time,input,position\n");
    for k in 0..1000 {
        let t = f64::from(k) * 1e-3;
        let mut row = [t, 1e-3 * (6.0 * t).sin(), 0.4 * (6.0 * t).cos()];
        edit(&mut row);
        writeln!(text, "{},{},{}", row[0], row[1], row[2]).unwrap();
    }
    text
}

fn message(manifest: &str, csv: impl AsRef<[u8]>) -> String {
    let folder = Folder::empty()
        .with("recording.toml", manifest)
        .with("a.csv", csv);
    let error = folder.read().expect_err("this input is bad").to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

/// The message about a manifest in which `from` is replaced by `to`.
fn manifest_message(from: &str, to: &str) -> String {
    assert!(MANIFEST.contains(from), "{from}");
    message(&MANIFEST.replacen(from, to, 1), csv(|_| {}))
}

/// The message about a CSV file in which `from` is replaced by `to`.
fn csv_message(from: &str, to: &str) -> String {
    let text = csv(|_| {});
    assert!(text.contains(from), "{from}");
    message(MANIFEST, text.replacen(from, to, 1))
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn the_unchanged_recording_is_good() {
    let folder = Folder::empty()
        .with("recording.toml", MANIFEST)
        .with("a.csv", csv(|_| {}));
    assert_eq!(folder.read().unwrap().runs[0].len(), 1000);
}

#[test]
fn missing_files() {
    let nothing = Folder::empty();
    assert_says(
        &nothing.read().unwrap_err().to_string(),
        &["recording.toml: cannot read", "give a folder with"],
    );
    let no_run = Folder::empty().with("recording.toml", MANIFEST);
    assert_says(
        &no_run.read().unwrap_err().to_string(),
        &["a.csv: cannot read", "correct `file`"],
    );
}

#[test]
fn broken_manifests() {
    assert_says(
        &manifest_message("title = ", "title "),
        &["recording.toml, line 2:"],
    );
    assert_says(
        &manifest_message("5e-4", "\"x\""),
        &["recording.toml, line 5:", "where a number belongs"],
    );
    assert_says(
        &manifest_message("inertia = 5e-4\n", ""),
        &["recording.toml, line 4:", "missing field `inertia`"],
    );
    assert_says(
        &manifest_message("horizon = 0.1\n", ""),
        &["recording.toml", "missing field `horizon`"],
    );
    assert_says(
        &manifest_message("open-loop", "open"),
        &["line 14:", "open-loop", "closed-loop"],
    );
    assert_says(
        &manifest_message("format = 1", "format = 2"),
        &["line 1: format 2", "`format = 1`"],
    );
    assert_says(
        &message(MANIFEST.split("[[").next().unwrap(), ""),
        &["recording.toml: there are no runs; add"],
    );
    assert_says(
        &manifest_message("a.csv", "../a.csv"),
        &["line 13:", "leads out", "put the CSV into the folder"],
    );
    assert_says(
        &manifest_message("a.csv", "/a.csv"),
        &["line 13:", "leads out"],
    );
}

#[test]
fn unknown_keys_that_would_have_no_effect() {
    assert_says(
        &manifest_message("inertia", "inertai"),
        &["line 5: [model] has no `inertai`; write `inertia`"],
    );
    assert_says(
        &manifest_message("coulomb", "Coulomb"),
        &["line 6:", "write `coulomb`"],
    );
    assert_says(
        &manifest_message("coulomb", "xyz"),
        &["line 6:", "it knows inertia, viscous"],
    );
    assert_says(
        &manifest_message("resolution", "resolutoin"),
        &["line 11: [sensor.position]", "write `resolution`"],
    );
    let tolerance = "[model.tolerance]\nviscos = 0.1\n[sensor.position]";
    assert_says(
        &manifest_message("[sensor.position]", tolerance),
        &["line 11: [model.tolerance]", "write `viscous`"],
    );
}

#[test]
fn numbers_that_no_device_has() {
    for (from, to, line, key, wanted) in [
        (
            "inertia = 5e-4",
            "inertia = 0",
            5,
            "model.inertia",
            "above 0",
        ),
        (
            "inertia = 5e-4",
            "inertia = -1",
            5,
            "model.inertia",
            "above 0",
        ),
        (
            "inertia = 5e-4",
            "inertia = nan",
            5,
            "model.inertia",
            "a finite number",
        ),
        (
            "inertia = 5e-4",
            "inertia = inf",
            5,
            "model.inertia",
            "a finite number",
        ),
        (
            "ratio = 15.0",
            "ratio = 0",
            8,
            "model.ratio",
            "other than 0",
        ),
        (
            "coulomb = 0.01",
            "coulomb = -0.01",
            6,
            "model.coulomb",
            "0 or above",
        ),
        ("horizon = 0.1", "horizon = 0", 3, "horizon", "above 0"),
        (
            "resolution = 1e-4",
            "resolution = -1e-4",
            11,
            "sensor.position.resolution",
            "0 or above",
        ),
        (
            "resolution = 1e-4",
            "cutoff_hz = 0",
            11,
            "sensor.position.cutoff_hz",
            "above 0",
        ),
        (
            "[-0.6, 0.6]",
            "[0.6, -0.6]",
            9,
            "model.travel",
            "the lower one first",
        ),
        (
            "gravity =",
            "input_limit = 0 #",
            7,
            "model.input_limit",
            "above 0",
        ),
    ] {
        let message = manifest_message(from, to);
        assert_says(
            &message,
            &[&format!("recording.toml, line {line}: `{key}` is"), wanted],
        );
    }
}

#[test]
fn sensors_without_a_column() {
    let message = manifest_message(
        "[sensor.position]",
        "[sensor.position_hall]\nnoise = 1.0\n[sensor.position]",
    );
    assert_says(
        &message,
        &[
            "recording.toml, line 10:",
            "[sensor.position_hall] belongs to no column",
            "remove it",
        ],
    );
}

#[test]
fn a_sensor_table_with_a_misspelt_column_name() {
    let manifest = MANIFEST.replace(
        "[sensor.position]",
        "[sensor.position_hal]\nnoise = 1.0\n[sensor.position]",
    );
    let with_hall =
        csv(|_| {})
            .replace('\n', ",1\n")
            .replacen("position,1", "position,position_hall", 1);
    assert_says(
        &message(&manifest, with_hall),
        &[
            "line 10: [sensor.position_hal]",
            "write [sensor.position_hall]",
        ],
    );
}

#[test]
fn broken_tables() {
    assert_says(
        &message(MANIFEST, ""),
        &["a.csv: there is no sample; put a header line"],
    );
    assert_says(
        &message(MANIFEST, "time,input,position\n"),
        &["a.csv: there is no sample"],
    );
    assert_says(
        &message(MANIFEST, csv(|_| {}).replace(',', ";")),
        &["a.csv, line 1:", "semicolons", "by commas"],
    );
    assert_says(
        &message(MANIFEST, csv(|_| {}).replace(',', "\t")),
        &["a.csv, line 1:", "tabs", "by commas"],
    );
    assert_says(
        &csv_message("time,input,position\n", ""),
        &["a.csv, line 1:", "add a header line"],
    );
    assert_says(
        &csv_message("input,", "torque,"),
        &["line 1: column `input` is missing; add it"],
    );
    assert_says(
        &csv_message("time,", "Time,"),
        &["line 1: column `time` is missing; rename `Time` to `time`"],
    );
    assert_says(
        &csv_message("input,", "time,"),
        &["line 1: column `time` is there twice; rename or remove"],
    );
    assert_says(
        &csv_message("\n0.007,", "\n0.007,1,"),
        &["a.csv, line 9:", "4 cells where the header has 3"],
    );
    assert_says(
        &csv_message("\n0.007,", "\n"),
        &[
            "a.csv, line 9:",
            "2 cells where the header has 3",
            "remove the row",
        ],
    );
}

#[test]
fn cells_that_are_no_numbers() {
    for cell in [
        "nan",
        "NaN",
        "inf",
        "-Infinity",
        "1e999",
        "",
        "1,5x".split(',').next_back().unwrap(),
        "\u{feff}1",
    ] {
        let message = csv_message("\n0.5,", &format!("\n{cell},"));
        assert_says(
            &message,
            &[
                "a.csv, line 502: `time` is `",
                "not a finite number; correct the cell",
            ],
        );
    }
    let supply = csv(|_| {})
        .replace('\n', ",12\n")
        .replacen("position,12", "position,supply", 1);
    assert_says(
        &message(MANIFEST, supply.replacen(",12\n", ",1e60\n", 1)),
        &["a.csv, line 2: `supply` is `1e60`"],
    );
}

#[test]
fn time_that_does_not_go_on() {
    assert_says(
        &csv_message("\n0.5,", "\n0.4,"),
        &[
            "a.csv, line 502: time goes from 0.499 s to 0.4 s",
            "sort the rows",
        ],
    );
    assert_says(
        &csv_message("\n0.5,", "\n0.499,"),
        &["a.csv, line 502:", "remove repeated ones"],
    );
}

#[test]
fn the_line_number_is_right_for_every_kind_of_line_end() {
    let bad = csv(|_| {}).replacen("\n0.5,", "\nx,", 1);
    assert_says(
        &message(MANIFEST, bad.replace('\n', "\r\n")),
        &["line 502:"],
    );
    assert_says(&message(MANIFEST, format!("\n\n{bad}")), &["line 504:"]);
    assert_says(
        &message(MANIFEST, bad.replacen("\nx,", "\n\n\nx,", 1)),
        &["line 504:"],
    );
    assert_says(
        &message(MANIFEST, bad.replacen("\nx,", "\r\n\r\nx,", 1)),
        &["line 503:"],
    );
    assert_says(&message(MANIFEST, format!("\u{feff}{bad}")), &["line 502:"]);
    assert_says(
        &message(MANIFEST, format!("{}x", csv(|_| {}))),
        &["line 1002:"],
    );
}

#[test]
fn samples_without_information() {
    let frozen = message(MANIFEST, csv(|row| row[2] = 0.25));
    assert_says(
        &frozen,
        &["a.csv: `position` is 0.25 in every row; name the live column"],
    );
    let short: String = csv(|_| {})
        .lines()
        .take(60)
        .flat_map(|line| [line, "\n"])
        .collect();
    assert_says(
        &message(MANIFEST, short),
        &[
            "a.csv: the run lasts 0.058 s, less than one horizon of 0.1 s",
            "record longer",
        ],
    );
}

#[test]
fn as_many_samples_as_one_horizon_are_enough() {
    let first = |rows: usize| -> String {
        csv(|_| {})
            .lines()
            .take(1 + rows)
            .flat_map(|line| [line, "\n"])
            .collect()
    };
    let read = |rows: usize| {
        let folder = Folder::empty();
        folder
            .with("recording.toml", MANIFEST)
            .with("a.csv", first(rows))
            .read()
    };
    assert!(read(100).is_ok());
    assert_says(
        &read(99).unwrap_err().to_string(),
        &["less than one horizon"],
    );
    assert_says(&read(1).unwrap_err().to_string(), &["the run lasts 0 s"]);
}

#[test]
fn unit_mistakes() {
    let degrees = |row: &mut [f64; 3]| row[2] = row[2].to_degrees();
    assert_says(
        &message(MANIFEST, csv(degrees)),
        &[
            "a.csv: `position` does not fit",
            "`travel`",
            "angles in rad",
        ],
    );
    let no_travel = MANIFEST.replace("travel = [-0.6, 0.6]\n", "");
    assert_says(
        &message(&no_travel, csv(degrees)),
        &[
            "a.csv: `position` does not fit",
            "accelerates",
            "angles in rad",
        ],
    );
    let milliseconds = message(MANIFEST, csv(|row| row[0] *= 1e3));
    assert_says(
        &milliseconds,
        &["a.csv: the median sample period is 1 s", "give `time` in s"],
    );
    let limited = MANIFEST.replace("ratio", "input_limit = 0.03\nratio");
    let milli = |row: &mut [f64; 3]| row[1] *= 1e3 / 0.7;
    assert_says(
        &message(&limited, csv(milli)),
        &["a.csv: `input` is typically", "in the same unit"],
    );
    let gram_square_millimetres = manifest_message("inertia = 5e-4", "inertia = 5e5");
    assert_says(
        &gram_square_millimetres,
        &["a.csv: `position` does not fit", "accelerates"],
    );
    let tiny = message(
        &no_travel.replace("5e-4", "5e-10"),
        csv(|row| row[1] = row[1] * 10.0 + 0.01),
    );
    assert_says(
        &tiny,
        &[
            "a.csv: in one horizon [model] would move",
            "in matching units",
        ],
    );
}

#[test]
fn a_badly_wrong_model_with_the_right_units_is_accepted() {
    for (from, to) in [
        ("inertia = 5e-4", "inertia = 2.5e-3"),
        ("inertia = 5e-4", "inertia = 1e-4"),
        ("ratio = 15.0", "ratio = 3.0"),
        ("ratio = 15.0", "ratio = -75.0"),
        ("coulomb = 0.01\ngravity = 0.0146\n", ""),
    ] {
        let folder = Folder::empty()
            .with("recording.toml", MANIFEST.replacen(from, to, 1))
            .with("a.csv", csv(|_| {}));
        folder
            .read()
            .unwrap_or_else(|error| panic!("{to}: {error}"));
    }
}

#[test]
fn writing_refuses_a_recording_that_could_not_be_read_back() {
    use recording::{Drive, Model, Recording, Run};
    let folder = Folder::empty();
    let mut recording = Recording::new("test", 0.1, Model::new(1.0));
    recording.runs.push(Run::new(
        "a.csv",
        Drive::OpenLoop,
        vec![0.0, 1.0],
        vec![0.0],
        vec![0.0, 1.0],
    ));
    let message = |recording: &Recording| recording.write(folder.path()).unwrap_err().to_string();
    assert_says(
        &message(&recording),
        &["column `input of a.csv` has 1 samples where `time` has 2"],
    );
    recording.runs[0].input.push(0.0);
    recording.runs.push(recording.runs[0].clone());
    assert_says(
        &message(&recording),
        &["two runs are called `a.csv`; give each run its own file"],
    );
    recording.runs[1].file = "../b.csv".into();
    assert_says(&message(&recording), &["`../b.csv` leads out"]);
    assert!(!folder.path().join("recording.toml").exists());
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(manifest in proptest::collection::vec(any::<u8>(), 0..200), csv in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Folder::empty().with("recording.toml", manifest).read();
        let _ = Folder::empty().with("recording.toml", MANIFEST).with("a.csv", csv).read();
    }

    #[test]
    fn no_damage_makes_it_panic(at in 0..MANIFEST.len(), byte in "[ -~\n]", row in 0..1000_usize, cell in "[-0-9a-z.,;\"\n\r ]{0,9}") {
        let mut manifest = MANIFEST.to_owned();
        manifest.replace_range(at..=at, &byte);
        let _ = Folder::empty().with("recording.toml", manifest).with("a.csv", csv(|_| {})).read();
        let mut rows: Vec<_> = csv(|_| {}).lines().map(str::to_owned).collect();
        rows[row] = cell;
        let _ = Folder::empty().with("recording.toml", MANIFEST).with("a.csv", rows.join("\n")).read();
    }
}

#[test]
fn utf_16_text_is_named_with_and_without_a_byte_order_mark() {
    let encoded = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let texts: [Vec<u8>; 2] = [
        encoded(&csv(|_| {})),
        encoded(&format!("\u{feff}{}", csv(|_| {}))),
    ];
    for bytes in texts {
        assert_says(
            &message(MANIFEST, bytes),
            &["a.csv: ", "UTF-16", "save it as UTF-8"],
        );
    }
    let manifest: Vec<u8> = encoded(MANIFEST);
    let folder = Folder::empty().with("recording.toml", manifest);
    let said = folder.read().unwrap_err().to_string();
    assert_says(&said, &["recording.toml: ", "UTF-16", "save it as UTF-8"]);
}

#[test]
fn a_comment_before_the_header_is_named() {
    for comment in ["# logged by the bench\n", "# a, b\n", "#"] {
        let said = message(MANIFEST, format!("{comment}{}", csv(|_| {})));
        assert_says(&said, &["a.csv, line 1: ", "begins with `#`", "remove"]);
    }
}

#[test]
fn an_impossibly_large_number_is_refused_in_every_column() {
    for (column, cell) in [
        ("input", "1e300"),
        ("position", "-1e300"),
        ("position", "1e21"),
    ] {
        let mut rows: Vec<String> = csv(|_| {}).lines().map(str::to_owned).collect();
        rows[3] = match column {
            "input" => format!("0.002,{cell},0.4"),
            _ => format!("0.002,0.001,{cell}"),
        };
        let said = message(MANIFEST, rows.join("\n"));
        assert_says(
            &said,
            &["a.csv, line 4: ", column, cell, "larger than anything"],
        );
    }
    let text = csv(|_| {}).replacen("position", "current", 1);
    let rows = text.lines().map(|row| match row.strip_suffix("current") {
        Some(names) => format!("{names}current,position"),
        None => format!("{row},{}", &row[row.rfind(',').unwrap() + 1..]),
    });
    let mut rows: Vec<String> = rows.collect();
    rows[2] = "0.001,0.001,1e300,0.4".into();
    assert_says(
        &message(MANIFEST, rows.join("\n")),
        &["line 3: ", "`current` is `1e300`", "larger"],
    );
}

#[test]
fn two_runs_of_one_file_are_refused() {
    let twice = format!("{MANIFEST}[[runs]]\nfile = \"a.csv\"\ndrive = \"open-loop\"\n");
    assert_says(
        &message(&twice, csv(|_| {})),
        &["recording.toml, line 16: ", "two runs are called `a.csv`"],
    );
}

#[cfg(unix)]
#[test]
fn a_pipe_without_a_writer_is_refused_without_waiting() {
    let pipe = |path: &std::path::Path| {
        let made = std::process::Command::new("mkfifo").arg(path).status();
        assert!(made.unwrap().success(), "{}", path.display());
    };
    let folder = Folder::empty().with("recording.toml", MANIFEST);
    pipe(&folder.path().join("a.csv"));
    assert_says(
        &folder.read().unwrap_err().to_string(),
        &["a.csv: ", "a pipe"],
    );
    let folder = Folder::empty();
    pipe(&folder.path().join("recording.toml"));
    assert_says(
        &folder.read().unwrap_err().to_string(),
        &["recording.toml: ", "a pipe"],
    );
}

#[test]
fn an_unknown_unit_gives_a_warning_and_a_known_one_does_not() {
    let warnings = |position: &str, input: &str| {
        let units = format!("[units]\nposition = \"{position}\"\ninput = \"{input}\"\n[model]");
        let folder = Folder::empty()
            .with("recording.toml", MANIFEST.replacen("[model]", &units, 1))
            .with("a.csv", csv(|_| {}));
        folder.read().unwrap().warnings().join("\n")
    };
    for (position, input) in [
        ("rad", "N m"),
        ("deg", "mN·m"),
        ("mm", "%"),
        ("counts", "rad/s"),
    ] {
        assert!(
            !warnings(position, input).contains("[units]"),
            "{position} {input}"
        );
    }
    assert_says(
        &warnings("furlong", "N m"),
        &["`furlong` under [units]", "`position`"],
    );
    assert_says(&warnings("radiant", "N m"), &["was `radian` meant?"]);
    assert_says(
        &warnings("rad", "fortnights"),
        &["`fortnights` under [units]", "`input`"],
    );
}

#[test]
fn validation_refuses_a_recording_that_could_not_be_read_back() {
    let folder = Folder::empty()
        .with("recording.toml", MANIFEST)
        .with("a.csv", csv(|_| {}));
    let whole = folder.read().unwrap();
    assert!(whole.validate().is_ok(), "{:?}", whole.validate());
    let elsewhere = Folder::empty();
    let nonsense = recording::Recording {
        horizon: 0.0,
        ..whole.clone()
    };
    let refused = nonsense.write(elsewhere.path()).unwrap_err().to_string();
    assert_says(&refused, &["`horizon` is 0", "above 0"]);
    assert!(
        elsewhere.path().read_dir().unwrap().next().is_none(),
        "something was written"
    );
    let mut still = whole;
    still.runs[0].position.fill(0.1);
    assert_says(
        &still.validate().unwrap_err().to_string(),
        &["a.csv: ", "in every row"],
    );
}
