//! A drive may give less than it is told: at most so much, or nothing for little.

mod made;

use gap::{Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

#[test]
fn a_lower_limit_is_found_where_most_inputs_are_beyond_the_nominal_one() {
    let limited = |limit| Model {
        input_limit: Some(limit),
        ..paddle()
    };
    let recording = recording(&limited(4e-4), limited(6e-4), 1e-4, 0.0, 5);
    let limit = only(&recording, "saturation", "limit");
    assert!((limit - 4e-4).abs() < 1e-5, "{limit}");
}

#[test]
fn a_limit_that_sets_in_little_by_little_is_one() {
    const LIMIT: f64 = 3.5e-3;
    let mut recording = recording(&paddle(), paddle(), 5e-5, 0.0, 3);
    // What acted is told as an actuator would have been that lets its hyperbolic tangent act.
    for told in &mut recording.runs[0].input {
        *told = LIMIT * (*told / LIMIT).atanh();
    }
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let saturation = &found.effects[0];
    assert_eq!(saturation.name, "saturation");
    assert!(saturation.shrink > 0.9, "{}", saturation.shrink);
    let knee = saturation.parameters["knee"].value;
    assert!((0.6..1.0).contains(&knee), "{knee}");
}

#[test]
fn a_wide_dead_band_is_not_taken_for_less_torque() {
    let mut device = Device::nominal(&paddle());
    let deadband: Effect = "deadband:width=1.2e-3,jump=0".parse().unwrap();
    deadband.install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 3);
    let width = only(&recording, "deadband", "width");
    assert!((width - 1.2e-3).abs() < 1e-5, "{width}");
}

/// A number of the effect that is to be the only one found.
fn only(recording: &Recording, name: &str, parameter: &str) -> f64 {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let names: Vec<&str> = found.effects.iter().map(|e| e.name).collect();
    assert_eq!(names, [name]);
    found.effects[0].parameters[parameter].value
}
