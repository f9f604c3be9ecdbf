//! Tests text in columns with different layouts.

use crate::support::{Folder, ROWS, assert_holds_samples, sample, table};
use flate2::Compression;
use flate2::write::GzEncoder;
use import::{ImportError, Recipe};
use std::io::Write;

fn comma(value: f64) -> String {
    value.to_string().replace('.', ",")
}

#[test]
fn any_layout_of_a_text_gives_the_same_samples() {
    let folder = Folder::new("layouts");
    let plain = |[t, u, x]: [f64; 3]| format!("{t},{u},{x}");
    let texts = [
        ("commas", table("time,torque [Nm],angle [rad]\n", plain)),
        (
            "semicolons",
            table("time;torque;angle\n", |[t, u, x]| format!("{t};{u};{x}")),
        ),
        (
            "decimal commas",
            table("Zeit;Torque;Winkel\n", |[t, u, x]| {
                format!("{};{};{}", comma(t), comma(u), comma(x))
            }),
        ),
        (
            "quoted decimal commas",
            table(
                "\"time\",\"torque, at the motor\",\"angle\"\n",
                |[t, u, x]| format!("\"{}\",\"{}\",\"{}\"", comma(t), comma(u), comma(x)),
            ),
        ),
        (
            "tabs",
            table("time\ttau\tq\n", |[t, u, x]| format!("{t}\t{u}\t{x}")),
        ),
        (
            "spaces",
            table("% time  tau   q\n", |[t, u, x]| format!("  {t}   {u}  {x}")),
        ),
        (
            "comments",
            table("# a logger\n# run 3, of Monday\n# time,tau,q\n", plain) + "# the end\n",
        ),
        (
            "preamble",
            table("Logger 3.1\nOperator: A, B, C and D\n\ntime,tau,q\n", plain),
        ),
        (
            "units in a row",
            table("time,tau,q\n(s),(N.m),(rad)\n\n", plain),
        ),
        (
            "line ends of another system",
            table("time,tau,q\r\n", |cells| plain(cells) + "\r"),
        ),
        (
            "a delimiter at the end",
            table("time,tau,q,\n", |cells| plain(cells) + ","),
        ),
        (
            "text beside",
            table("time,state,tau,q\n", |[t, u, x]| {
                format!("{t},RUNNING,{u},{x}")
            }),
        ),
        (
            "a mark in front",
            format!("\u{feff}{}", table("time,tau,q\n", plain)),
        ),
        (
            "ms and degrees",
            table("t_ms,tau_mNm,q_deg\n", |[t, u, x]| {
                format!("{},{},{}", 1e3 * t, 1e3 * u, x.to_degrees())
            }),
        ),
        (
            "us",
            table("micros,tau,q\n", |[t, u, x]| {
                format!("{:.0},{u},{x}", 1e6 * t)
            }),
        ),
        (
            "ns since 1970",
            table("stamp,tau,q\n", |[t, u, x]| {
                format!("1700000000{:09.0},{u},{x}", 1e9 * t)
            }),
        ),
        (
            "dates",
            table("date,tau,q\n", |[t, u, x]| {
                format!("2026-01-02T03:04:{:09.6}Z,{u},{x}", 5.0 + t)
            }),
        ),
        (
            "turns",
            table("time,tau,q [rev]\n", |[t, u, x]| {
                format!("{t},{u},{}", x / std::f64::consts::TAU)
            }),
        ),
    ];
    for (of, text) in texts {
        let imported = folder
            .import("log.csv", text, &Recipe::default())
            .unwrap_or_else(|error| panic!("{of}: {error}"));
        assert_holds_samples(&imported, 1e-9, of);
    }
}

#[test]
fn a_packed_log_and_other_encodings_are_read() {
    let folder = Folder::new("packed");
    let text = table("time,tau,angle [°]\n", |[t, u, x]| {
        format!("{t},{u},{}", x.to_degrees())
    });
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text.as_bytes()).expect("packed");
    let wide: Vec<u8> = [0xFF, 0xFE]
        .into_iter()
        .chain(text.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let latin: Vec<u8> = text
        .chars()
        .map(|c| u8::try_from(u32::from(c)).expect("Latin"))
        .collect();
    for (of, bytes) in [
        ("gzip", packed.finish().expect("packed")),
        ("UTF-16", wide),
        ("Latin-1", latin),
    ] {
        let imported = folder
            .import("log.csv.gz", bytes, &Recipe::default())
            .unwrap_or_else(|error| panic!("{of}: {error}"));
        assert_holds_samples(&imported, 1e-9, of);
    }
}

#[test]
fn columns_without_names_are_called_by_their_number() {
    let folder = Folder::new("unnamed");
    let text = table("", |[t, u, x]| format!("{x} {t} {u}"));
    let recipe = Recipe {
        time: Some("c2".into()),
        input: Some("c3".into()),
        position: Some("c1".into()),
        ..Recipe::default()
    };
    assert_holds_samples(
        &folder.import("log.txt", &text, &recipe).expect("imported"),
        0.0,
        "no header",
    );
    let refused = folder.import("log.txt", &text, &Recipe::default());
    assert!(
        matches!(refused, Err(ImportError::NotGuessed { .. })),
        "{refused:?}"
    );
}

#[test]
fn an_input_is_computed_from_other_columns() {
    let folder = Folder::new("formula");
    let text = table("time,setp,q[2]\n", |[t, u, x]| {
        format!("{t},{},{x}", 100.0 * u * 15.0 + x)
    });
    let recipe = Recipe {
        input: Some("0.01*(setp - {q[2]})/15:Nm".into()),
        position: Some("q[2]:rad".into()),
        ..Recipe::default()
    };
    assert_holds_samples(
        &folder.import("log.csv", text, &recipe).expect("imported"),
        1e-12,
        "formula",
    );
}

#[test]
fn rows_of_several_rates_are_merged() {
    let folder = Folder::new("rates");
    // Each topic has its own rows. The input has twice the rate of the position and the right mean.
    let mut text = "__time,/cmd/effort,/joint/position\n".to_owned();
    for k in 0..ROWS {
        let [t, u, x] = sample(k);
        text += &format!(
            "{t},,{x}\n{t},{},\n{},{},\n",
            u - 0.001,
            t + 1e-3,
            u + 0.001
        );
    }
    let imported = folder
        .import("log.csv", text, &Recipe::default())
        .expect("imported");
    let run = &imported.recording.runs[0];
    assert_eq!(
        run.len(),
        usize::try_from(ROWS).expect("a count"),
        "{:?}",
        imported.notes
    );
    for (k, found) in (0..ROWS - 1).zip(&run.input) {
        let wanted = sample(k)[1];
        assert!(
            (found - wanted).abs() < 1e-9,
            "row {k}: {found} for {wanted}"
        );
    }
}

#[test]
fn several_runs_of_one_file_are_told_apart() {
    let folder = Folder::new("runs");
    let twice = |second: &dyn Fn([f64; 3]) -> String| {
        let first = table("time,tau,q,episode\n", |[t, u, x]| format!("{t},{u},{x},0"));
        first + &table("", second)
    };
    let anew = twice(&|[t, u, x]| format!("{t},{u},{x},0"));
    let later = twice(&|[t, u, x]| format!("{},{u},{x},0", t + 30.0));
    let told = twice(&|[t, u, x]| format!("{},{u},{x},1", t + 0.8));
    for (of, text, split_by) in [
        ("anew", anew, None),
        ("a gap", later, None),
        ("a column", told, Some("episode".to_owned())),
    ] {
        let recipe = Recipe {
            split_by,
            ..Recipe::default()
        };
        let imported = folder
            .import("log.csv", text, &recipe)
            .unwrap_or_else(|error| panic!("{of}: {error}"));
        let lengths: Vec<usize> = imported
            .recording
            .runs
            .iter()
            .map(recording::Run::len)
            .collect();
        assert_eq!(lengths, [ROWS as usize; 2], "{of}");
        let files: Vec<&str> = imported
            .recording
            .runs
            .iter()
            .map(|run| run.file.as_str())
            .collect();
        assert_ne!(files[0], files[1], "{of}");
    }
}

#[test]
fn a_position_is_integrated_from_a_velocity() {
    let folder = Folder::new("velocity");
    let text = table("time,tau,qd\n", |[t, u, _]| {
        format!("{t},{u},{}", -2.7 * (9.0 * t).sin())
    });
    let recipe = Recipe {
        velocity: Some("qd".into()),
        ..Recipe::default()
    };
    let imported = folder.import("log.csv", text, &recipe).expect("imported");
    assert!(
        imported.is_integrated && imported.roles.iter().any(|role| role.contains("integral")),
        "{:?}",
        imported.roles
    );
    for (k, found) in (0..ROWS).zip(&imported.recording.runs[0].position) {
        let wanted = sample(k)[2] - 0.3;
        assert!(
            (found - wanted).abs() < 1e-4,
            "row {k}: {found} for {wanted}"
        );
    }
}

#[test]
fn unusable_logs_are_refused_with_a_remedy() {
    let folder = Folder::new("refused");
    let log = table("time,tau,q,still\n", |[t, u, x]| format!("{t},{u},{x},3"));
    let recipe = |position: &str| Recipe {
        position: Some(position.into()),
        ..Recipe::default()
    };
    for (of, text, recipe, said) in [
        (
            "a frozen position",
            log.as_str(),
            recipe("still"),
            "as if it were not live",
        ),
        (
            "a misspelt name",
            &log,
            recipe("qq"),
            "there is no column `qq` (was `q` meant?)",
        ),
        (
            "another unit",
            &log,
            recipe("q:V"),
            "is no unit of position",
        ),
        (
            "counts alone",
            &log,
            recipe("q:counts"),
            "--counts-per-turn",
        ),
        ("a broken formula", &log, recipe("2*(q"), "formula"),
        (
            "prose",
            "All happy families are alike.\nEach other one is not.\n",
            Recipe::default(),
            "no rows of numbers",
        ),
        ("nothing", "", Recipe::default(), "no rows of numbers"),
    ] {
        let error = folder
            .import("log.csv", text, &recipe)
            .err()
            .unwrap_or_else(|| panic!("{of} was imported"))
            .to_string();
        assert!(error.contains(said), "{of}: {error}");
        assert!(!error.contains('\n'), "{of}: {error}");
    }
}

#[test]
fn frozen_columns_are_reported() {
    let folder = Folder::new("frozen");
    let text = table("time,tau,q,motor current [A]\n", |[t, u, x]| {
        format!("{t},{u},{x},0.25")
    });
    let imported = folder
        .import("log.csv", text, &Recipe::default())
        .expect("imported");
    assert!(
        imported
            .notes
            .iter()
            .any(|note| note.contains("motor current")),
        "{:?}",
        imported.notes
    );
}
