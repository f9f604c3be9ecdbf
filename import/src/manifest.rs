//! Writes a commented `recording.toml`.

use crate::error::ImportError;
use crate::known::{Kind, Known, Number};
use crate::sensor::three_digits;
use crate::start::{self, Inertia};
use recording::{Drive, InputSampling, Recording};
use std::fmt::Write;

/// Least stated tolerance of an estimated inertia, relative. Other effects bias the estimate.
const ESTIMATED: f64 = 0.3;

/// Meaning of each number of `[model]`, as comments.
const MEANINGS: [(&str, &str); 15] = [
    ("inertia", "at the joint, the motor's rotor included"),
    ("viscous", "torque = -viscous * velocity"),
    ("coulomb", "dry friction level at the joint"),
    (
        "gravity",
        "torque = -gravity * sin(position - gravity_zero)",
    ),
    ("gravity_zero", "position at which it hangs"),
    (
        "stiffness",
        "torque = -stiffness * (position - stiffness_zero)",
    ),
    ("stiffness_zero", "position at which the spring rests"),
    ("offset", "constant torque at the joint"),
    ("ratio", "torque at the joint per unit of input"),
    ("delay", "s, from input to torque"),
    ("lag", "s, first order, from input to torque"),
    ("input_limit", "|input| is clipped here"),
    ("input_rate_limit", "input acts no faster, per s"),
    (
        "error_deadband",
        "of a servo: no torque where |input - position| is smaller",
    ),
    ("travel", "hard stops, [lower, upper]"),
];

/// The numbers of `[motor]` with their meanings.
const MOTOR: [(&str, &str); 4] = [
    ("kt", "torque constant, N m/A"),
    ("resistance", "of the winding, Ohm"),
    ("gear", "turns of the motor per turn of the joint"),
    ("supply", "V, where the input is a duty cycle"),
];

/// The text of a manifest for `recording` with the known properties of the device. The inertia is estimated from the motion
/// if it is unknown, because a model needs one. Other unknown numbers are left out, so that the diagnosis estimates them.
///
/// # Errors
///
/// [`ImportError::Motor`] and [`ImportError::Option`] for contradicting properties.
pub fn manifest(
    recording: &Recording,
    known: &Known,
    roles: &[String],
    is_integrated: bool,
) -> Result<String, ImportError> {
    let units = &recording.units;
    let mut numbers = known.numbers(&units.input)?;
    let data_sheet = known.data_sheet(units)?;
    let mut tolerances = known.tolerances.clone();
    if !numbers.contains_key("inertia") {
        let ratio = numbers.get("ratio").map(|number| number.value);
        let ratio = ratio.or(data_sheet.map(|(_, ratio)| ratio));
        let stiffness = numbers.get("stiffness").map_or(0.0, |number| number.value);
        if ratio.is_none() {
            let why = "not known; torque is counted in units of input, then".into();
            numbers.insert("ratio", Number { value: 1.0, why });
        }
        let found = start::inertia(recording, ratio.unwrap_or(1.0), stiffness);
        let (value, why, deviation) = match found {
            Some(Inertia { value, deviation }) if deviation < 1.0 => (
                value,
                "estimated from this recording: replace it by what you know",
                deviation,
            ),
            Some(Inertia { value, deviation }) => (
                value,
                "only its order, from this recording, which does not tell more: replace it by what you know",
                deviation,
            ),
            None => (
                1.0,
                "not known, and this recording does not tell: replace it by what you know",
                1.0,
            ),
        };
        let value = three_digits(value);
        numbers.insert(
            "inertia",
            Number {
                value,
                why: why.into(),
            },
        );
        let tolerance = (deviation.max(ESTIMATED) * 100.0).round() / 100.0;
        tolerances.entry("inertia".into()).or_insert(tolerance);
    }
    let mut text = String::new();
    // Writing to a `String` cannot fail.
    let mut line = |written: String| {
        let _ = writeln!(text, "{written}");
    };
    line("# A recording for `paddle gap diagnose`. The format: docs/recording-format.md".into());
    for role in roles {
        line(format!("# {role}"));
    }
    line("format = 1".into());
    line(format!("title = {}", quoted(&recording.title)));
    line(commented(
        "horizon",
        recording.horizon,
        "s; how far the model predicts before it starts anew from what was measured",
    ));
    if recording.restart_half_width != Recording::RESTART_HALF_WIDTH {
        line(commented(
            "restart_half_width",
            recording.restart_half_width,
            "s",
        ));
    }
    line(String::new());
    line("[units]".into());
    line(format!("position = {}", quoted(&units.position)));
    line(format!("input = {}", quoted(&units.input)));
    line(String::new());
    if let Some((motor, ratio)) = data_sheet {
        line(format!(
            "[motor]  # its data sheet: {ratio:.4e} of torque at the joint per unit of input"
        ));
        for (name, meaning) in MOTOR {
            match motor.get(name) {
                Some(value) => line(commented(name, value, meaning)),
                None => line(format!("# {name} = 0.0  # {meaning}")),
            }
        }
        line(String::new());
    }
    line("# The nominal simulation: the model whose gap is asked about. Numbers without # are taken as stated; ratio, viscous,".into());
    line("# coulomb and gravity are estimated if they are left out, the others are then taken as absent.".into());
    line("[model]".into());
    for (name, meaning) in MEANINGS {
        if name.starts_with("gravity") && (known.kind == Kind::Linear || units.is_length()) {
            continue;
        }
        match numbers.get(name) {
            Some(number) => line(commented(
                name,
                number.value,
                &format!("{meaning}; {}", number.why),
            )),
            None if name == "ratio" && data_sheet.is_some() => {}
            None if name == "viscous" && data_sheet.is_some() => {
                line(format!(
                    "# {name} = 0.0  # {meaning}, beside the back-EMF of [motor]"
                ));
            }
            None if name == "travel" => line(format!("# {name} = [-1.0, 1.0]  # {meaning}")),
            None => line(format!("# {name} = 0.0  # {meaning}")),
        }
    }
    for (name, number) in numbers
        .iter()
        .filter(|(name, _)| MEANINGS.iter().all(|(known, _)| known != *name))
    {
        line(commented(name, number.value, &number.why));
    }
    line(String::new());
    line("[model.tolerance]  # relative standard deviation of each number; one that is left out is exact".into());
    for (name, tolerance) in &tolerances {
        line(format!("{name} = {tolerance:?}"));
    }
    if !tolerances.contains_key("viscous") {
        line("# viscous = 0.2".into());
    }
    for (column, sensor) in &recording.sensors {
        line(String::new());
        line(format!(
            "[sensor.{}]  # as the readings show it",
            key(column)
        ));
        if is_integrated && column == "position" {
            line("# There was no position: this column is the integral of a velocity, and may drift.".into());
        }
        line(commented(
            "resolution",
            sensor.resolution,
            "quantum; 0 = continuous",
        ));
        line(commented(
            "noise",
            sensor.noise,
            "standard deviation before quantising",
        ));
        match sensor.cutoff_hz {
            Some(cutoff_hz) => line(commented("cutoff_hz", cutoff_hz, "low-pass in the column")),
            None => line("# cutoff_hz = 100.0  # low-pass that is in the column, if any".into()),
        }
    }
    for run in &recording.runs {
        line(String::new());
        line("[[runs]]".into());
        line(format!("file = {}", quoted(&run.file)));
        let drive = match run.drive {
            Drive::OpenLoop => "open-loop",
            Drive::ClosedLoop => "closed-loop",
        };
        line(format!(
            "drive = \"{drive}\"  # \"open-loop\" if the input does not depend on the position, else \"closed-loop\""
        ));
        if run.input_time_std > 0.0 {
            line(commented(
                "input_time_std",
                run.input_time_std,
                "s; the time between input and position is uncertain by this",
            ));
        }
        if run.input_sampling == InputSampling::Point {
            line("input_sampling = \"point\"".into());
        }
        if let Some(pid) = &run.controller {
            line("[runs.controller]".into());
            line("kind = \"pid\"".into());
            for (name, value) in [
                ("kp", pid.kp),
                ("ki", pid.ki),
                ("kd", pid.kd),
                ("period", pid.period),
            ] {
                line(format!("{name} = {value:?}"));
            }
            if let Some(cutoff_hz) = pid.position_cutoff_hz {
                line(format!("position_cutoff_hz = {cutoff_hz:?}"));
            }
        }
    }
    Ok(text)
}

fn commented(name: &str, value: f64, comment: &str) -> String {
    format!("{name} = {value:?}  # {comment}")
}

/// A text as a quoted TOML string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            control if control.is_control() => quoted.push(' '),
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}

/// A TOML key, quoted if necessary.
fn key(name: &str) -> String {
    let is_bare = name
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    if is_bare {
        name.to_owned()
    } else {
        quoted(name)
    }
}
