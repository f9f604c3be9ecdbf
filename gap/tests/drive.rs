//! A drive may give less than it is told, at most so much or nothing for little, and later.

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
    let all = found
        .effects
        .iter()
        .map(|e| (e.name, e.confidence, e.shrink));
    assert!(
        saturation.shrink > 0.9,
        "{:?} {:?}",
        all.collect::<Vec<_>>(),
        found.numbers
    );
    let knee = saturation.parameters["knee"].value;
    assert!((0.6..1.0).contains(&knee), "{knee}");
}

#[test]
fn a_wide_dead_band_is_not_taken_for_less_torque() {
    let recording = hiding("deadband:width=1.2e-3,jump=0", &paddle());
    let width = only(&recording, "deadband", "width");
    assert!((width - 1.2e-3).abs() < 1e-5, "{width}");
}

#[test]
fn a_dead_band_is_found_before_the_limit_or_behind_it() {
    let limited = Model {
        input_limit: Some(1.6e-3),
        ..paddle()
    };
    for first in [0.0, 1.0] {
        let hidden = format!("deadband:width=2e-4,first={first}");
        assert_eq!(only(&hiding(&hidden, &limited), "deadband", "first"), first);
        // Without a limit there is no order.
        assert_eq!(only(&hiding(&hidden, &paddle()), "deadband", "first"), 0.0);
    }
}

#[test]
fn a_lag_is_found_behind_that_of_the_model_or_as_more_of_it() {
    let lagging = Model {
        lag: 8e-3,
        ..paddle()
    };
    for apart in [0.0, 1.0] {
        let hidden = format!("lag:time=8e-3,apart={apart}");
        assert_eq!(only(&hiding(&hidden, &lagging), "lag", "apart"), apart);
        assert_eq!(only(&hiding(&hidden, &paddle()), "lag", "apart"), 0.0);
    }
}

/// A recording of a device that is `nominal` but for an effect.
fn hiding(hidden: &str, nominal: &Model) -> Recording {
    let mut device = Device::nominal(nominal);
    hidden.parse::<Effect>().unwrap().install(&mut device);
    recorded(&device, *nominal, 2e-5, 0.0, 11)
}

/// A number of the effect that is to be the only one found.
fn only(recording: &Recording, name: &str, parameter: &str) -> f64 {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let names: Vec<&str> = found.effects.iter().map(|e| e.name).collect();
    assert_eq!(names, [name]);
    found.effects[0].parameters[parameter].value
}
