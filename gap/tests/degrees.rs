//! A pendulum whose position is in degrees is the same pendulum.

mod made;

use gap::{ModelFile, Options, Recording, diagnose, measure};
use host_sim::device::Device;
use made::{paddle, recording};
use recording::Model;

/// The same recording in degrees, as it is read from a folder.
fn in_degrees(radians: &Recording) -> Recording {
    let deg = 1f64.to_degrees();
    let mut recording = radians.clone();
    recording.units.position = "deg".into();
    recording.model.inertia /= deg;
    recording.model.viscous /= deg;
    for sensor in recording.sensors.values_mut() {
        sensor.noise *= deg;
    }
    for position in recording.runs.iter_mut().flat_map(|r| &mut r.position) {
        *position *= deg;
    }
    let folder = std::env::temp_dir().join(format!("degrees-{}", std::process::id()));
    recording.write(&folder).unwrap();
    let read = Recording::read(&folder).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    read
}

#[test]
fn another_weight_is_found_in_degrees_as_in_radians() {
    const WEIGHT_NM: f64 = 0.025;
    let heavier = Model {
        gravity: WEIGHT_NM,
        ..paddle()
    };
    let radians = recording(&heavier, paddle(), 5e-5, 0.0, 11);
    let degrees = in_degrees(&radians);
    let before = |recording: &Recording| {
        let (gap, _) = measure(recording, &Device::nominal(&recording.model));
        gap.before
    };
    let ratio = before(&degrees) / before(&radians).to_degrees();
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");

    let outcome = diagnose(&degrees, &Options::default());
    let [weight] = &outcome.diagnosis.effects[..] else {
        panic!("{:?}", outcome.diagnosis);
    };
    let found = weight.parameters["weight"].value;
    assert_eq!(weight.name, "gravity");
    assert!((found / WEIGHT_NM - 1.0).abs() < 0.03, "{found}");

    let file = ModelFile::new(&outcome.model, &degrees).to_string();
    let (alone, _) = file.parse::<ModelFile>().unwrap().apart().unwrap();
    assert_eq!(alone.device(), outcome.model.device());
}
