//! A corrected model goes to a file and comes back as it was.

use gap::missing_torque::table::{Table, TableAxis};
use gap::model_file::{ModelFile, ModelFileError};
use gap::{CorrectedEffect, CorrectedModel, measure};
use host_sim::effects::{EffectError, KINDS, kind};
use recording::{Drive, Model, Recording, Run};

fn recording(amplitude: f64) -> Recording {
    let time: Vec<f64> = (0..1500).map(|k| f64::from(k) * 1e-3).collect();
    let position = time.iter().map(|t| amplitude * (9.0 * t).sin()).collect();
    let input = time.iter().map(|t| 0.01 * (9.0 * t).cos()).collect();
    let mut recording = Recording::new("A \"paddle\"", 0.25, Model::new(5.755e-4));
    let run = Run::new("sine.csv", Drive::OpenLoop, time, input, position);
    recording.runs.push(run);
    recording
}

/// Numbers that a short decimal does not hold.
fn awkward(names: &[&str]) -> CorrectedModel {
    let effects = names.iter().map(|name| {
        let kind = kind(name).unwrap();
        let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default / 0.3).collect();
        if *name == "lost_counts" {
            values.extend([1.0 / 1.7, -0.1 / 3.0]);
        }
        CorrectedEffect {
            effect: host_sim::effects::Effect { kind, values },
            sensor_on_load: *name == "compliance",
        }
    });
    CorrectedModel {
        tables: vec![Table {
            axis: TableAxis::Velocity,
            at: vec![-1.5, 0.1, 0.3],
            torque: vec![0.1 / 3.0, 0.0, -2e-3],
        }],
        effects: effects.collect(),
        model: Model {
            viscous: 1e-3 / 3.0,
            gravity: 0.1 + 0.2,
            coulomb: 1e-3 / 7.0,
            input_limit: Some(1.0 / 17.0),
            travel: Some([-1.0 / 3.0, 2.0 / 3.0]),
            ..Model::new(5.755e-4 / 1.1)
        },
    }
}

fn predicted(recording: &Recording, model: &CorrectedModel) -> Vec<u64> {
    let (_, runs) = measure(recording, &model.device());
    let values = runs.iter().flat_map(|run| &run.predicted);
    values.map(|p| p.to_bits()).collect()
}

#[test]
fn every_effect_comes_back_to_the_same_predictions() {
    let recording = recording(0.2);
    let plain = predicted(&recording, &awkward(&[]));
    for kind in KINDS {
        let model = awkward(&[kind.name]);
        let text = ModelFile::new(&model, &recording).to_string();
        let read: ModelFile = text.parse().unwrap();
        let (back, left_out) = read.on(&recording).unwrap();
        assert!(left_out.is_empty());
        assert_eq!(back.device(), model.device(), "{text}");
        assert_eq!(predicted(&recording, &back), predicted(&recording, &model));
        if kind.name == "compliance" {
            assert_ne!(predicted(&recording, &model), plain);
        }
    }
}

#[test]
fn what_belongs_to_a_moment_stays_with_its_recording() {
    let model = awkward(&["contact", "stribeck", "lost_counts"]);
    let (here, elsewhere) = (recording(0.2), recording(0.21));
    let text = ModelFile::new(&model, &here).to_string();
    let read: ModelFile = text.parse().unwrap();

    let (same, left_out) = read.on(&here).unwrap();
    assert!(left_out.is_empty());
    assert_eq!(predicted(&here, &same), predicted(&here, &model));

    let (other, left_out) = read.on(&elsewhere).unwrap();
    let names: Vec<_> = left_out.iter().map(|left| left.effect).collect();
    assert_eq!(names, ["contact", "lost_counts"]);
    assert!(left_out[0].to_string().contains("A \"paddle\""));
    assert_eq!(other.device(), awkward(&["stribeck"]).device());
}

#[test]
fn a_spoilt_file_is_refused_with_the_mend() {
    let recording = recording(0.2);
    let good = ModelFile::new(&awkward(&["stribeck"]), &recording).to_string();
    let refusal = |from: &str, to: &str| {
        let spoilt = good.replacen(from, to, 1);
        assert_ne!(spoilt, good, "{from} is not in {good}");
        let read = spoilt.parse::<ModelFile>();
        read.and_then(|file| file.on(&recording)).unwrap_err()
    };
    assert_eq!(
        refusal("format = 1", "format = 2"),
        ModelFileError::Format(2)
    );
    assert!(
        matches!(refusal("inertia", "inertai"), ModelFileError::Toml(m) if m.starts_with("line "))
    );
    assert_eq!(
        refusal("name = \"stribeck\"", "name = \"stribek\""),
        ModelFileError::Effect(EffectError::Kind("stribek".into()))
    );
    assert!(matches!(
        refusal("static_ratio", "ratio"),
        ModelFileError::Effect(_)
    ));
    for value in ["0.9", "nan"] {
        let beyond = refusal("static_ratio = ", &format!("static_ratio = {value} #"));
        assert!(beyond.to_string().ends_with("write 1 or more"), "{beyond}");
    }
    assert!(matches!(
        refusal("velocity =", "#"),
        ModelFileError::Missing { .. }
    ));
    for (from, to) in [
        ("inertia = ", "inertia = -"),
        ("viscous = ", "viscous = nan #"),
        ("coulomb = ", "coulomb = -0.1 #"),
        ("ratio = ", "ratio = 0.0 #"),
    ] {
        let refused = refusal(from, to);
        assert!(
            matches!(refused, ModelFileError::Model(_)),
            "{to}: {refused}"
        );
    }
}

#[test]
fn two_effects_of_one_name_are_refused_whatever_their_numbers() {
    let recording = recording(0.2);
    let good = ModelFile::new(&awkward(&["stribeck", "viscous"]), &recording).to_string();
    let second = good.find("[[effects]]").unwrap();
    let twice = format!("{good}\n{}", &good[second..]);
    let read = twice.parse::<ModelFile>().unwrap().on(&recording);
    assert_eq!(
        read.unwrap_err(),
        ModelFileError::Effect(EffectError::Twice("stribeck"))
    );
    assert!(good.parse::<ModelFile>().unwrap().on(&recording).is_ok());
}
