//! Another form of a dry friction is no finding where it hardly shows.

mod made;

use gap::diagnosis::{Diagnosis, Verdict};
use gap::{Device, Effect, Options, diagnose};
use made::{paddle, recorded, recording};
use recording::Model;

/// A paddle with bristles in place of stick, which bend by so much before they slide, seen with so much noise.
fn bristled(distance: f64, coulomb: f64, noise: f64) -> Diagnosis {
    let nominal = Model {
        coulomb,
        ..paddle()
    };
    let mut device = Device::nominal(&nominal);
    let bristles = format!("presliding:distance={distance},damping=0.02");
    bristles.parse::<Effect>().unwrap().install(&mut device);
    let recording = recorded(&device, nominal, noise, 0.0, 1);
    diagnose(&recording, &Options::default()).diagnosis
}

#[test]
fn nothing_is_found_in_stick_that_is_as_stated() {
    let recording = recording(&paddle(), paddle(), 3e-5, 0.0, 1);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    assert_eq!(found.verdict, Verdict::NoGap, "{:?}", found.effects);
}

#[test]
fn bristles_are_no_finding_where_they_alone_make_a_gap_near_its_floor() {
    let hardly = bristled(2e-5, 0.014, 4e-5);
    assert_eq!(hardly.verdict, Verdict::NoGap, "{:?}", hardly.effects);
    assert!(hardly.gap.before > 1.5 * hardly.gap.floor);
}

#[test]
fn they_are_one_where_they_show_however_little_they_bend() {
    let found = bristled(4e-5, 0.02, 3e-5);
    assert_eq!(found.verdict, Verdict::Explained);
    let presliding = &found.effects[0];
    assert_eq!((presliding.name, found.effects.len()), ("presliding", 1));
    let distance = presliding.parameters["distance"].value;
    assert!((2e-5..8e-5).contains(&distance), "{distance}");
    // As the effect's definition has them.
    let names: Vec<&String> = presliding.parameters.keys().collect();
    assert_eq!(names, ["distance", "damping", "exponent", "elastic"]);
}
