//! What shows in a window or two cannot be held out, and that is said.

mod made;

use gap::{Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

#[test]
fn a_shrink_on_data_that_the_fit_has_seen_is_said_to_be() {
    let drags = Model {
        viscous: 8e-4,
        ..paddle()
    };
    assert_held_out(true, "viscous", &recording(&drags, paddle(), 5e-5, 0.0, 11));

    let hand = "contact:position=0.05,side=0,stiffness=0.3,damping=0.003,from=3,to=3.4";
    let mut device = Device::nominal(&paddle());
    hand.parse::<Effect>().unwrap().install(&mut device);
    assert_held_out(
        false,
        "contact",
        &recorded(&device, paddle(), 5e-5, 0.0, 11),
    );
}

#[test]
fn a_limit_that_is_reached_once_is_found_and_has_been_seen() {
    const LIMIT: f64 = 2.5e-3;
    let limited = Model {
        input_limit: Some(LIMIT),
        ..paddle()
    };
    let mut recording = recording(&limited, paddle(), 1e-5, 0.0, 11);
    assert_held_out(true, "saturation", &recording);
    // In its first 2.7 s the input comes that far in one window.
    let run = &mut recording.runs[0];
    for column in [&mut run.time, &mut run.input, &mut run.position] {
        column.truncate(5400);
    }
    assert_held_out(false, "saturation", &recording);
}

/// That one effect is named, and whether its shrink is on data that the fit has not seen.
fn assert_held_out(held_out: bool, name: &str, recording: &Recording) {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let [effect] = &found.effects[..] else {
        panic!("{found:?}");
    };
    assert_eq!((effect.name, effect.held_out), (name, held_out));
    let is_said = found.warnings.iter().any(|w| w.contains("held out"));
    assert_eq!(is_said, !held_out, "{:?}", found.warnings);
}
