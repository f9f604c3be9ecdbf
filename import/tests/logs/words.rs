//! Tests counters and registers.

use crate::support::{Folder, assert_holds_samples, table};
use import::Recipe;
use std::f64::consts::TAU;

#[test]
fn wrapping_counts_and_words_with_a_sign_bit_are_decoded() {
    let folder = Folder::new("words");
    // A counter with 2^20 counts per turn that starts at the end of a turn, and a load with its sign in bit 15.
    let turn = f64::from(1 << 20);
    let text = table("time,load,enc_counts\n", |[t, u, x]| {
        let counts = (x / TAU * turn).round().rem_euclid(turn);
        let size = (u.abs() * 1e6).round();
        let word = if u < 0.0 { size + 32_768.0 } else { size };
        format!("{t},{word},{counts}")
    });
    let recipe = Recipe {
        input: Some("1*load".into()),
        counts_per_turn: Some(turn),
        ..Recipe::default()
    };
    let recipe = Recipe {
        input: Some("load".into()),
        input_sign_bit: Some(15),
        ..recipe
    };
    let mut imported = folder.import("log.csv", text, &recipe).expect("imported");
    imported.recording.runs[0]
        .input
        .iter_mut()
        .for_each(|u| *u *= 1e-6);
    assert_holds_samples(&imported, 1e-5, "words");
    assert!(
        imported.roles.iter().any(|role| role.contains("undone")),
        "{:?}",
        imported.roles
    );
    let sensor = imported.recording.sensor("position");
    assert_eq!(sensor.resolution, TAU / turn);
}

#[test]
fn a_wrapping_angle_is_unwrapped() {
    let folder = Folder::new("wraps");
    let text = table("time,tau,q_deg\n", |[t, u, x]| {
        let degrees = x.to_degrees() + 175.0;
        let wrapped = if degrees > 180.0 {
            degrees - 360.0
        } else {
            degrees
        };
        format!("{t},{u},{wrapped}")
    });
    let mut imported = folder
        .import("log.csv", text, &Recipe::default())
        .expect("imported");
    imported.recording.runs[0]
        .position
        .iter_mut()
        .for_each(|x| *x += 185_f64.to_radians());
    assert_holds_samples(&imported, 1e-9, "an angle");
}
