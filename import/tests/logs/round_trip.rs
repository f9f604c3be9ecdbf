//! A recording is imported unchanged.

use crate::support::{Folder, sample, table};
use import::{Recipe, import, read_log};
use proptest::prelude::*;
use recording::{Actuator, Drive, Model, Motor, Recording, Run};

#[test]
fn an_imported_recording_is_identical_bit_for_bit() {
    let folder = Folder::new("again");
    let text = table(
        "stamp [ms],motor torque [mNm],angle [deg],Target\n",
        |[t, u, x]| {
            format!(
                "{},{},{},{}",
                17.3 + 1e3 * t,
                1e3 * u,
                x.to_degrees(),
                3.0 * x
            )
        },
    );
    let mut first = folder
        .import("log.csv", text, &Recipe::default())
        .expect("imported")
        .recording;
    first.horizon = 0.1;
    first.write(folder.path().join("one")).expect("written");
    let file = folder.path().join("one").join(&first.runs[0].file);
    let second = import(&[read_log(&file).expect("read")], &Recipe::default())
        .expect("imported")
        .recording;
    assert_eq!(bits(&first.runs[0]), bits(&second.runs[0]));
}

fn bits(run: &Run) -> Vec<Vec<u64>> {
    let columns = [&run.time, &run.input, &run.position]
        .into_iter()
        .chain(&run.setpoint)
        .chain(run.positions.values());
    columns
        .map(|column| column.iter().map(|value| value.to_bits()).collect())
        .collect()
}

proptest! {
    #[test]
    fn any_samples_are_imported_unchanged(
        periods in prop::collection::vec(1e-4..1e-2, 40..60),
        inputs in prop::collection::vec(-1e3..1e3, 60),
        positions in prop::collection::vec(-1e2..1e2, 60),
        start in prop_oneof![Just(0.0), -1e3..1e3, Just(1.7e9)],
    ) {
        let folder = Folder::new("any");
        let mut t = start;
        let time: Vec<f64> = periods.iter().map(|period| { t += period; t }).collect();
        prop_assume!(time.windows(2).all(|pair| pair[0] < pair[1]));
        let count = time.len();
        let mut recording = Recording::new("any", 0.01, Model::new(1.0));
        let run = Run::new("a.csv", Drive::OpenLoop, time, inputs[..count].to_vec(), positions[..count].to_vec());
        recording.runs.push(run);
        recording.write(folder.path()).expect("written");
        let recipe = Recipe { wrap: Some(0.0), ..Recipe::default() };
        let again = import(&[read_log(&folder.path().join("a.csv")).expect("read")], &recipe).expect("imported");
        prop_assert_eq!(bits(&recording.runs[0]), bits(&again.recording.runs[0]));
    }
}

/// Writes the manifest for a log of a device with these known properties. Returns its text and the recording read with it.
fn written_and_read(
    folder: &Folder,
    imported: &import::Imported,
    known: &import::Known,
) -> (String, Recording) {
    let out = folder.path().join("out");
    imported.recording.write(&out).expect("written");
    let manifest =
        import::manifest(&imported.recording, known, &imported.roles, false).expect("a manifest");
    std::fs::write(out.join("recording.toml"), &manifest).expect("written");
    let read = Recording::read(&out).unwrap_or_else(|error| panic!("{error}\n{manifest}"));
    (manifest, read)
}

#[test]
fn the_written_manifest_can_be_read() {
    let folder = Folder::new("manifest");
    let text = table("time,tau,q\n", |[t, u, x]| format!("{t},{u},{x}"));
    let imported = folder
        .import("log \"1\".csv", text, &Recipe::default())
        .expect("imported");
    let known = import::Known {
        motor: Motor {
            gear: Some(2.0),
            ..Motor::default()
        },
        ..import::Known::default()
    };
    let (_, read) = written_and_read(&folder, &imported, &known);
    assert_eq!(read.runs[0].len(), imported.recording.runs[0].len());
    assert_eq!(read.model.ratio, 2.0);
    assert_eq!(read.unstated, ["viscous", "coulomb", "gravity"]);
    // The torque amplitude of the samples is 0.02 N m times the gear, for 0.3 rad at 9 rad/s.
    let wanted = 2.0 * 0.02 / (0.3 * 81.0);
    let off = read.model.inertia / wanted;
    assert!(
        (0.1..10.0).contains(&off),
        "{} for {wanted}; {:?}",
        read.model.inertia,
        sample(1)
    );
}

#[test]
fn a_data_sheet_is_written_to_the_manifest_unchanged() {
    let folder = Folder::new("motor");
    let text = table("time,voltage [V],q\n", |[t, u, x]| format!("{t},{u},{x}"));
    let imported = folder
        .import("log.csv", text, &Recipe::default())
        .expect("imported");
    let motor = Motor {
        kt: Some(0.0538),
        resistance: Some(10.6),
        gear: Some(15.0),
        ..Motor::default()
    };
    let known = import::Known {
        motor,
        ..import::Known::default()
    };
    let (manifest, read) = written_and_read(&folder, &imported, &known);
    assert_eq!(read.actuator, Some(Actuator::Motor(motor)), "{manifest}");
    assert_eq!(read.unstated, ["viscous", "coulomb", "gravity"]);
    assert!((read.model.ratio / (15.0 * 0.0538 / 10.6) - 1.0).abs() < 1e-12);
    assert!(read.model.viscous > 0.06, "{}", read.model.viscous);
    let twice = import::Known {
        numbers: [("ratio".to_owned(), 1.0)].into(),
        ..known
    };
    let error = import::manifest(&imported.recording, &twice, &[], false)
        .expect_err("said twice")
        .to_string();
    assert!(error.contains("leave one out"), "{error}");
}
