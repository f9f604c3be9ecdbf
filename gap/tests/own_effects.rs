//! An effect that a user writes down is searched, named, saved and read as any other.

mod made;

use gap::effects::add_own;
use gap::{Device, ModelFile, Options, diagnose, measure};
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};

const BRAKE: &str = r#"
    name = "eddy_brake"
    about = "a brake by eddy currents, whose torque falls at speed"
    torque = "-k * v / (1 + (v / v0)^2)"

    [parameters.k]
    typical = [1e-4, 1e-1]
    quantity = "damping"

    [parameters.v0]
    typical = [0.3, 30.0]
    quantity = "velocity"
"#;

#[test]
fn a_torque_that_is_written_down_is_found_with_its_numbers() {
    assert_eq!(add_own(BRAKE), Ok("eddy_brake"));
    let mut device = Device::nominal(&paddle());
    let brake: Effect = "eddy_brake:k=0.006,v0=1.2".parse().expect("it is known");
    brake.install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
    let outcome = diagnose(&recording, &Options::default());
    let effects = &outcome.diagnosis.effects;
    let names: Vec<&str> = effects.iter().map(|effect| effect.name).collect();
    assert_eq!(names, ["eddy_brake"], "{:?}", outcome.diagnosis.gap);
    for (name, expected) in [("k", 0.006), ("v0", 1.2)] {
        let value = effects[0].parameters[name].value;
        assert!((value / expected - 1.0).abs() < 0.1, "{name} {value}");
    }
    let (after, _) = measure(&recording, &outcome.model.device());
    assert!(after.before < 1.3 * after.floor, "{after:?}");

    let saved = ModelFile::new(&outcome.model, &recording).to_string();
    let read: ModelFile = saved.parse().expect("it reads back");
    let (read, left_out) = read.on(&recording).expect("it is known");
    let (again, _) = measure(&recording, &read.device());
    assert_eq!((left_out.len(), again), (0, after));

    // Where it is not there it is not named.
    let plain = recording_of_viscous();
    let found = diagnose(&plain, &Options::default()).diagnosis.effects;
    let names: Vec<&str> = found.iter().map(|effect| effect.name).collect();
    assert_eq!(names, ["viscous"]);
}

/// A paddle that drags more than its model.
fn recording_of_viscous() -> gap::Recording {
    let drags = recording::Model {
        viscous: 1e-3,
        ..paddle()
    };
    recording(&drags, paddle(), 5e-5, 0.0, 12)
}

#[test]
fn an_invalid_definition_states_the_cause_and_the_remedy() {
    let with = |from: &str, to: &str| {
        let text = BRAKE.replace("eddy_brake", "other_brake").replace(from, to);
        add_own(&text).expect_err(to).to_string()
    };
    let cases = [
        ("-k * v", "-k * (v", "not a valid expression"),
        ("-k * v", "-k * q * v", "declare it in [parameters.q]"),
        ("v / v0", "v", "does not use the parameter `v0`"),
        ("[1e-4, 1e-1]", "[1e-1, 1e-4]", "`typical` of `k`"),
        ("other_brake", "coulomb", "give yours another name"),
        ("\"damping\"", "\"mass\"", "line 8"),
        ("[parameters.k]", "[parameters.x]", "is a variable"),
    ];
    for (from, to, said) in cases {
        let error = with(from, to);
        assert!(error.contains(said), "{to}: {error}");
    }
}
