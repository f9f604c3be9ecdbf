//! Tests of error messages and of the formatting of numbers.

use crate::support::{DEMO, assert_says, file, folder, json, refusal};
use serde_json::Value;

#[test]
fn text_in_place_of_an_integer_is_refused_in_plain_words() {
    for (arguments, option) in [
        (&["sim", "step", "--seed", "x"][..], "--seed"),
        (&["sim", "step", "--seed", "1.5"], "--seed"),
        (&["board", "--seed", "x"], "--seed"),
        (&["gap", "blind", "--cases", "x"], "--cases"),
        (&["gap", "blind", "--jobs=-2"], "--jobs"),
        (&["gap", "blind", "--seed", "1,x"], "--seed"),
    ] {
        let line = refusal(arguments);
        assert!(!line.contains("digit found in string"), "{line}");
        assert_says(&line, &[option]);
    }
    assert_says(
        &refusal(&["sim", "step", "--seed", "x"]),
        &["must be a whole number, 0 or above"],
    );
}

#[test]
fn text_in_place_of_a_number_is_reported_without_rust_types() {
    let out = folder("types");
    let differs = file(&out, "differs.toml", "[model]\ninertia = \"heavy\"\n");
    let line = refusal(&["gap", "measure", DEMO, "--model", &differs]);
    assert_says(
        &line,
        &["differs.toml", "`inertia` is \"heavy\"", "must be a number"],
    );
    let whole = file(
        &out,
        "whole.toml",
        "format = 1\n[model]\ninertia = \"heavy\"\n",
    );
    let line = refusal(&["gap", "measure", DEMO, "--model", &whole]);
    assert_says(
        &line,
        &[
            "whole.toml",
            "line 3",
            "\"heavy\" stands where a number belongs",
        ],
    );
    let effect = file(&out, "effect.toml", "with = [3]\n");
    assert_says(
        &refusal(&["sim", "step", "--plant", &effect]),
        &["effect.toml", "3 is no text"],
    );
    let wide: String = "[model]\ninertia = 1\n"
        .encode_utf16()
        .map(|unit| unit as u8 as char)
        .flat_map(|c| [c, '\0'])
        .collect();
    let wide = file(&out, "wide.toml", &wide);
    assert_says(
        &refusal(&["sim", "step", "--plant", &wide]),
        &["wide.toml", "UTF-16"],
    );
}

#[test]
fn a_file_that_is_not_an_image_is_named() {
    let out = folder("no-image");
    let bad = file(&out, "bad.elf", "not an image");
    assert_says(
        &refusal(&["board", "--seconds", "1", "--elf", &bad]),
        &[&bad, "32-bit ELF"],
    );
    let header = [
        &b"\x7fELF\x01\x01\x01"[..],
        &[0; 9],
        &[2, 0, 62, 0],
        &[0; 32],
    ]
    .concat();
    std::fs::write(&bad, header).unwrap();
    assert_says(
        &refusal(&["board", "--seconds", "1", "--elf", &bad]),
        &[&bad, "another processor"],
    );
}

/// Lists the numbers in `value` with more digits than the program should print.
fn overlong_numbers(value: &Value) -> Vec<String> {
    let digits = |text: &str| {
        let mantissa = text.split(['e', 'E']).next().unwrap_or(text);
        let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
        digits.trim_matches('0').len()
    };
    match value {
        Value::Number(number) if number.is_f64() && digits(&number.to_string()) > 12 => {
            vec![number.to_string()]
        }
        Value::Array(values) => values.iter().flat_map(overlong_numbers).collect(),
        Value::Object(values) => values.values().flat_map(overlong_numbers).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn numbers_in_json_have_no_rounding_digits() {
    let out = folder("dust");
    let out = out.to_str().unwrap();
    for arguments in [
        &["sim", "step", "--plant", "refit", "--out", out][..],
        &["sim", "ramp", "--plant", "refit", "--out", out],
        &["sim", "zn", "--plant", "refit", "--out", out],
        &["gap", "measure", DEMO],
        &["effects"],
    ] {
        let said = json(arguments);
        assert_eq!(
            overlong_numbers(&said),
            Vec::<String>::new(),
            "{arguments:?}"
        );
    }
    // A number of single precision is printed as it was typed.
    let said = json(&["sim", "step", "--kd", "0.0008", "--out", out]);
    assert_eq!(said["gains"]["kd_nm_s_per_deg"].to_string(), "0.0008");
}

#[test]
fn the_output_of_a_simulation_states_gains_and_version() {
    let out = folder("provenance");
    let out = out.to_str().unwrap();
    let said = json(&[
        "sim",
        "step",
        "--kp",
        "0.04",
        "--with",
        "lag:time=0.002",
        "--seed",
        "5",
        "--set",
        "metrics.band=0.3",
        "--out",
        out,
    ]);
    assert_eq!(said["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(said["gains"]["kp_nm_per_deg"], 0.04);
    let rig = &said["rig"];
    assert_eq!(
        (&rig["plant"], &rig["seed"]),
        (&"nominal".into(), &5.into())
    );
    assert_eq!(rig["with"][0]["name"], "lag");
    assert_eq!(rig["with"][0]["parameters"]["time"], 0.002);
    assert_eq!(rig["settings"]["metrics.band"], 0.3);
    assert_eq!(rig["settings"]["estimate.sensor"], "encoder");
    for arguments in [
        &["sim", "zn", "--plant", "refit", "--out", out][..],
        &["effects"],
    ] {
        assert_eq!(json(arguments)["version"], env!("CARGO_PKG_VERSION"));
    }
}
