//! A column with the wrong sign is found, said and worked around, one in another unit refused.

mod made;

use gap::recording::Oddity;
use gap::{Device, Options, Recording, diagnose, inspected, measure};
use made::{paddle, recording};
use recording::Model;

const NOISE: f64 = 5e-5;

/// A paddle that hangs askew and drags more than its model says.
fn dragging() -> Recording {
    let askew = Model {
        gravity_zero: 0.3,
        ..paddle()
    };
    let device = Model {
        viscous: 8e-4,
        ..askew
    };
    recording(&device, askew, NOISE, 0.0, 11)
}

fn negate(column: &mut [f64]) {
    column.iter_mut().for_each(|x| *x = -*x);
}

/// The column that a recording's oddities say has the wrong sign.
fn said(recording: &Recording) -> Option<&str> {
    recording.oddities.iter().find_map(|oddity| match oddity {
        Oddity::OppositeSign { column, .. } => Some(*column),
        _ => None,
    })
}

#[test]
fn the_column_with_the_wrong_sign_is_said_and_makes_no_difference() {
    let right = dragging();
    let gap = |recording: &Recording| measure(recording, &Device::nominal(&recording.model)).0;
    let expected = gap(&right);
    for (column, turn) in [
        (
            "input",
            (|r| negate(&mut r.runs[0].input)) as fn(&mut Recording),
        ),
        ("position", |r| negate(&mut r.runs[0].position)),
    ] {
        let mut wrong = right.clone();
        turn(&mut wrong);
        let wrong = inspected(wrong).unwrap();
        assert_eq!(said(&wrong), Some(column));
        assert!((gap(&wrong).before / expected.before - 1.0).abs() < 1e-9);
        let found = diagnose(&wrong, &Options::default()).diagnosis;
        let names: Vec<&str> = found.effects.iter().map(|effect| effect.name).collect();
        assert_eq!(names, ["viscous"], "with the other sign of {column}");
        assert!(found.warnings.iter().any(|w| w.contains(column)));
    }
}

#[test]
fn a_right_recording_is_left_as_it_is() {
    let right = dragging();
    assert_eq!(inspected(right.clone()), Ok(right));
}

#[test]
fn a_model_that_its_input_makes_worse_is_not_turned_for_that() {
    // An actuator that has been dead, and a spring that nobody knows of.
    let device = Model {
        ratio: 1e-3,
        stiffness: 0.1,
        ..paddle()
    };
    let dead = recording(&device, paddle(), NOISE, 0.0, 11);
    assert_eq!(said(&inspected(dead).unwrap()), None);
}

/// A free inertia under two sines of torque that come late by half a period of the larger one.
fn late_by_half_a_period() -> Recording {
    let free = Model {
        ratio: 15.0,
        ..Model::new(5.755e-4)
    };
    let sines = [[12.0, 0.0015], [20.0, 0.0006]];
    let delay_s = std::f64::consts::PI / 12.0;
    let mut recording = recording(&free, free, NOISE, 0.0, 11);
    let run = &mut recording.runs[0];
    let columns = run.input.iter_mut().zip(&mut run.position);
    for (t, (input, position)) in run.time.iter().zip(columns) {
        (*input, *position) = (0.0, 0.0);
        for [rate, amplitude] in sines {
            *input += amplitude * (rate * t).sin();
            let angle = free.ratio * amplitude / (free.inertia * rate * rate);
            *position -= angle * (rate * (t - delay_s)).sin();
        }
    }
    recording
}

#[test]
fn an_input_that_is_late_by_half_a_period_has_no_wrong_sign() {
    let late = inspected(late_by_half_a_period()).unwrap();
    assert_eq!(said(&late), None);
}

#[test]
fn a_column_in_another_unit_is_refused() {
    let right = dragging();
    let degrees = 180.0 / std::f64::consts::PI;
    for (column, factor) in [("position", degrees), ("input", 1e3), ("input", 1e-3)] {
        let mut wrong = right.clone();
        let run = &mut wrong.runs[0];
        let values = match column {
            "input" => &mut run.input,
            _ => &mut run.position,
        };
        values.iter_mut().for_each(|x| *x *= factor);
        let mistake = inspected(wrong).unwrap_err();
        assert_eq!((mistake.column, mistake.factor), (column, factor));
        assert!(mistake.left < 0.5, "{mistake}");
    }
}
