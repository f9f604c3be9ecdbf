//! What pulls is no ripple of which less than a wave was travelled.

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
