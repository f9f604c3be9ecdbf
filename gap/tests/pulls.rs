//! What pulls or pushes is no ripple of which less than a wave was travelled.

mod made;

use gap::{Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

/// What is named, in the order of the alphabet.
fn named(recording: &Recording) -> Vec<&'static str> {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let mut names: Vec<&str> = found.effects.iter().map(|effect| effect.name).collect();
    names.sort_unstable();
    names
}

/// What is named of some effects.
fn named_of(hidden: &[&str]) -> Vec<&'static str> {
    let mut device = Device::nominal(&paddle());
    for effect in hidden {
        effect.parse::<Effect>().unwrap().install(&mut device);
    }
    named(&recorded(&device, paddle(), 5e-5, 0.0, 11))
}

#[test]
fn two_pulls_are_both_named() {
    let offset = "torque_offset:torque=0.008";
    let pulls = named_of(&["gravity:weight=0.04,zero=0", offset]);
    assert_eq!(pulls, ["gravity", "torque_offset"]);
    let pulls = named_of(&["spring:stiffness=0.02,zero=0,hardening=3", offset]);
    assert_eq!(pulls, ["spring", "torque_offset"]);
}

#[test]
fn one_is_named_alone() {
    let heavier = Model {
        gravity: 0.04,
        ..paddle()
    };
    assert_eq!(
        named(&recording(&heavier, paddle(), 5e-5, 0.0, 11)),
        ["gravity"]
    );
}

#[test]
fn a_push_from_outside_is_named_with_its_torque_and_its_time() {
    let push = "push:torque=0.03,from=2.4,to=2.55";
    let mut device = Device::nominal(&paddle());
    push.parse::<Effect>().unwrap().install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let effect = &found.effects[0];
    assert_eq!(effect.name, "push");
    for (name, expected, within) in [
        ("torque", 0.03, 0.003),
        ("from", 2.4, 0.01),
        ("to", 2.55, 0.01),
    ] {
        let value = effect.parameters[name].value;
        assert!((value - expected).abs() < within, "{name} {value}");
    }
}

#[test]
fn an_input_of_limited_rate_is_named_with_its_rate() {
    let mut device = Device::nominal(&paddle());
    let limit = "rate_limit:rate=0.012";
    limit.parse::<Effect>().unwrap().install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let effect = &found.effects[0];
    assert_eq!(effect.name, "rate_limit");
    let rate = effect.parameters["rate"].value;
    assert!((rate / 0.012 - 1.0).abs() < 0.03, "{rate}");
}

/// A position servo on the paddle.
fn servo() -> Model {
    Model {
        ratio: 0.5,
        stiffness: 0.5,
        ..paddle()
    }
}

/// The gap of `nominal` on a recording of `device`, rad.
fn gap_of(nominal: Model, device: &Model) -> f64 {
    let recording = recording(device, nominal, 5e-5, 0.0, 11);
    gap::measure(&recording, &Device::nominal(&nominal))
        .0
        .before
}

#[test]
fn a_servo_whose_speed_limit_is_stated_leaves_no_gap() {
    let limited = Model {
        input_rate_limit: Some(0.003),
        ..servo()
    };
    let exact = gap_of(servo(), &servo());
    let stated = gap_of(limited, &limited);
    let left_out = gap_of(servo(), &limited);
    assert!(stated < 1.1 * exact, "{stated} {exact}");
    assert!(left_out > 1.5 * stated, "{left_out} {stated}");
}

#[test]
fn a_servo_whose_dead_band_is_stated_leaves_no_gap() {
    let dead = Model {
        error_deadband: Some(0.004),
        ..servo()
    };
    let exact = gap_of(servo(), &servo());
    let stated = gap_of(dead, &dead);
    let left_out = gap_of(servo(), &dead);
    assert!(stated < 1.2 * exact, "{stated} {exact}");
    assert!(left_out > 2.0 * stated, "{left_out} {stated}");
}
