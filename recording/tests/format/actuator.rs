//! Tests actuators described by a motor's data sheet or as a position servo.

use crate::folder::Folder;
use recording::{Actuator, Motor, Recording, Servo, Units};

/// A folder with one run. `tables` is inserted before `[model]`, and `numbers` into it.
fn folder(units: &str, tables: &str, numbers: &str) -> Folder {
    let rows: String = (0..600)
        .map(|k| {
            let t = 1e-3 * f64::from(k);
            format!(
                "{t},{},{}\n",
                0.01 * (20.0 * t).sin(),
                -0.004 * (20.0 * t).sin()
            )
        })
        .collect();
    Folder::empty()
        .with("a.csv", format!("time,input,position\n{rows}"))
        .with(
            "recording.toml",
            format!(
                "format = 1\nhorizon = 0.1\n{units}\n{tables}\n[model]\ninertia = 6e-4\n{numbers}\n[[runs]]\nfile = \"a.csv\"\ndrive = \"open-loop\"\n[runs.model]\nviscous = 2e-3\n"
            ),
        )
}

fn input(unit: &str) -> String {
    format!("[units]\ninput = \"{unit}\"")
}

const SHEET: &str = "[motor]\nkt = 0.05\nresistance = 10.0\ngear = 15.0\nsupply = 24.0";

fn assert_near(found: f64, wanted: f64, of: &str) {
    assert!(
        (found - wanted).abs() <= 1e-12 * wanted.abs(),
        "{of}: {found} for {wanted}"
    );
}

#[test]
fn a_data_sheet_gives_ratio_and_back_emf_of_the_inputs_unit() {
    let back_emf = 15.0_f64.powi(2) * 0.05 * 0.05 / 10.0;
    for (unit, ratio, share) in [
        ("N m", 15.0, 0.0),
        ("A", 0.75, 0.0),
        ("V", 0.075, back_emf),
        ("duty", 24.0 * 0.075, back_emf),
    ] {
        let read = folder(&input(unit), SHEET, "viscous = 1e-3")
            .read()
            .expect(unit);
        assert_near(read.model.ratio, ratio, unit);
        assert_near(read.model.viscous, 1e-3 + share, unit);
        assert_near(read.model_of(&read.runs[0]).viscous, 2e-3 + share, unit);
        assert_eq!(read.unstated, ["coulomb", "gravity"], "{unit}");
    }
    let sheet = Motor {
        kt: Some(0.05),
        ..Motor::default()
    };
    let units = Units {
        input: "mA".into(),
        ..Units::default()
    };
    assert_eq!(sheet.ratio(&units), Ok(0.05e-3));
    // An unstated friction starts with the contribution of the back-EMF and is then estimated.
    let read = folder(&input("V"), SHEET, "").read().expect("read");
    assert_near(read.model.viscous, back_emf, "viscous");
    assert_eq!(read.unstated, ["viscous", "coulomb", "gravity"]);
}

#[test]
fn the_back_emf_of_a_joint_in_degrees_is_per_degree() {
    let units = "[units]\nposition = \"deg\"\ninput = \"V\"";
    let read = folder(units, SHEET, "viscous = 0.0").read().expect("read");
    assert_near(read.model.viscous, 0.05625_f64.to_radians(), "viscous");
}

#[test]
fn a_servo_gives_ratio_stiffness_and_damping() {
    let servo = "servo = { stiffness = 0.5, damping = 0.002 }\nviscous = 1e-3";
    let read = folder("", "", servo).read().expect("read");
    assert_eq!((read.model.ratio, read.model.stiffness), (0.5, 0.5));
    assert_near(read.model.viscous, 3e-3, "viscous");
    assert_eq!(read.unstated, ["coulomb", "gravity"]);
    assert_eq!(read.model.input_rate_limit, None);
    let limited = "servo = { stiffness = 0.5, speed_limit = 5.0 }";
    let read = folder("", "", limited).read().expect("read");
    assert_eq!(read.model.input_rate_limit, Some(5.0));
    assert_eq!(read.model.error_deadband, None);
    let dead = "servo = { stiffness = 0.5, deadband = 0.01 }";
    let read = folder("", "", dead).read().expect("read");
    assert_eq!(read.model.error_deadband, Some(0.01));
}

#[test]
fn an_actuator_is_written_as_it_was_described() {
    let servo = "servo = { stiffness = 0.5, damping = 0.002, deadband = 0.01 }\nviscous = 1e-3";
    for (units, tables, numbers) in [
        (input("V"), SHEET, "viscous = 1e-3"),
        (input("V"), SHEET, ""),
        (String::new(), "", servo),
    ] {
        let read = folder(&units, tables, numbers).read().expect("read");
        let copy = Folder::empty();
        read.write(copy.path()).expect("written");
        let again = copy.read().expect("read again");
        assert_eq!(
            (again.actuator, &again.unstated),
            (read.actuator, &read.unstated)
        );
        assert_eq!(
            (again.model.ratio, again.model.stiffness),
            (read.model.ratio, read.model.stiffness)
        );
        assert_near(again.model.viscous, read.model.viscous, numbers);
        assert_near(
            again.model_of(&again.runs[0]).viscous,
            read.model_of(&read.runs[0]).viscous,
            numbers,
        );
    }
}

#[test]
fn an_actuator_that_the_model_no_longer_contains_is_written_as_numbers() {
    let mut recording: Recording = folder("", "", "servo = { stiffness = 0.5 }")
        .read()
        .expect("read");
    recording.model.ratio = 0.6;
    let copy = Folder::empty();
    recording.write(copy.path()).expect("written");
    let again = copy.read().expect("read again");
    assert_eq!(again.actuator, None);
    assert_eq!((again.model.ratio, again.model.stiffness), (0.6, 0.5));
    let servo = Servo {
        stiffness: 0.5,
        damping: 0.0,
        speed_limit: None,
        deadband: 0.0,
    };
    assert_eq!(recording.actuator, Some(Actuator::Servo(servo)));
}

#[test]
fn an_invalid_actuator_is_refused_in_one_line_with_the_remedy() {
    let kt = "[motor]\nkt = 0.05";
    for (units, tables, numbers, said) in [
        (
            input("A"),
            kt,
            "ratio = 1.0",
            "[motor] and `ratio` of [model] both define the actuator; leave one out",
        ),
        (input("V"), kt, "", "lacks `resistance`"),
        (input("kg"), kt, "", "says nothing of an input in `kg`"),
        (input("A"), "[motor]\nkt = -1.0", "", "motor.kt"),
        (
            input("A"),
            "[motor]\nkv = 1.0",
            "",
            "kt, resistance, gear, supply",
        ),
        (
            input("A"),
            "[motor]\nkt = 1e300\ngear = 1e300",
            "",
            "model.ratio",
        ),
        (
            String::new(),
            kt,
            "servo = { stiffness = 1.0 }",
            "[motor] and `servo` of [model]",
        ),
        (
            String::new(),
            "",
            "servo = { stiffness = 1.0 }\nstiffness = 1.0",
            "`stiffness` of [model]",
        ),
        (
            String::new(),
            "",
            "servo = { stiffness = 0.0 }",
            "model.servo.stiffness",
        ),
        (String::new(), "", "servo = { damping = 0.1 }", "stiffness"),
        (
            String::new(),
            "",
            "servo = { stiffness = 1.0, speed = 1.0 }",
            "speed_limit",
        ),
        (
            String::new(),
            "",
            "servo = 3",
            "stands where a table belongs",
        ),
    ] {
        let error = folder(&units, tables, numbers)
            .read()
            .expect_err(said)
            .to_string();
        assert!(
            error.contains(said) && error.contains("recording.toml"),
            "{said}: {error}"
        );
        assert!(!error.contains('\n'), "{error}");
    }
}
