//! Runs with different loads share what the device has beyond its model.

mod made;

use gap::{Device, MissingTorque, Options, Recording, diagnose, measure};
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

const NOISE: f64 = 5e-5;

fn loaded() -> Model {
    Model {
        inertia: 2.5 * paddle().inertia,
        gravity: 0.06,
        ..paddle()
    }
}

/// A recording of one run with each load, of which the second one states its load.
fn two_loads(mut recording: Recording, mut second: Recording) -> Recording {
    let mut second = second.runs.remove(0);
    second.file = "loaded.csv".to_owned();
    second.time.iter_mut().for_each(|time_s| *time_s += 100.0);
    let numbers = [("inertia", loaded().inertia), ("gravity", loaded().gravity)];
    second.numbers = numbers.map(|(name, value)| (name.to_owned(), value)).into();
    recording.runs.push(second);
    recording
}

/// The same of a device that has an effect beyond its model.
fn with_effect(hidden: &str) -> Recording {
    let run = |model: Model, seed| {
        let mut device = Device::nominal(&model);
        hidden.parse::<Effect>().unwrap().install(&mut device);
        recorded(&device, model, NOISE, 0.0, seed)
    };
    two_loads(run(paddle(), 11), run(loaded(), 12))
}

#[test]
fn an_effect_that_both_loads_share_is_named_with_its_number() {
    let recording = with_effect("viscous:coefficient=0.0009");
    let outcome = diagnose(&recording, &Options::default());
    let effects = &outcome.diagnosis.effects;
    let names: Vec<&str> = effects.iter().map(|effect| effect.name).collect();
    assert_eq!(names, ["viscous"]);
    let found = effects[0].parameters["coefficient"].value;
    assert!((found / 9e-4 - 1.0).abs() < 0.03, "{found}");
    let (after, runs) = measure(&recording, &outcome.model.device());
    assert_eq!(runs.len(), 2);
    assert!(after.before < 1.2 * after.floor, "{after:?}");
}

#[test]
fn a_device_that_is_as_its_runs_say_leaves_no_gap() {
    let run = |model: Model, seed| recording(&model, model, NOISE, 0.0, seed);
    let mut recording = two_loads(run(paddle(), 11), run(loaded(), 12));
    let gap = |of: &Recording| measure(of, &Device::nominal(&of.model)).0;
    let told = gap(&recording);
    assert!(told.before < 1.2 * told.floor, "{told:?}");
    recording.runs[1].numbers.clear();
    let untold = gap(&recording);
    assert!(untold.before > 10.0 * untold.floor, "{untold:?}");
}

#[test]
fn the_missing_torque_is_of_runs_with_one_load() {
    let recording = with_effect("torque_offset:torque=0.01");
    let missing = MissingTorque::of(&recording, &Device::nominal(&recording.model));
    let runs = missing.runs();
    assert_eq!(runs.len(), 1);
    let mean = runs[0].torque.iter().sum::<f64>() / runs[0].torque.len() as f64;
    assert!((mean / 0.01 - 1.0).abs() < 0.2, "{mean} N m");
}
