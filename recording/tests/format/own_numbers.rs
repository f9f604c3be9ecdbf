//! Tests runs with their own model numbers.

use crate::folder::Folder;
use recording::{Drive, Model, Recording, Run};

fn recording() -> Recording {
    let time: Vec<f64> = (0..600).map(|k| f64::from(k) * 1e-3).collect();
    let wave = |scale: f64| -> Vec<f64> { time.iter().map(|t| scale * (20.0 * t).sin()).collect() };
    let run = |file| Run::new(file, Drive::OpenLoop, time.clone(), wave(0.01), wave(-0.04));
    let mut recording = Recording::new(
        "two loads",
        0.1,
        Model {
            coulomb: 1e-4,
            ..Model::new(6e-4)
        },
    );
    recording.runs = vec![run("light.csv"), run("heavy.csv")];
    recording.runs[1].numbers =
        [("inertia".to_owned(), 1.8e-3), ("gravity".to_owned(), 0.03)].into();
    recording
}

#[test]
fn numbers_of_a_run_replace_those_of_the_model_in_that_run() {
    let folder = Folder::empty();
    recording().write(folder.path()).expect("written");
    let read = Recording::read(folder.path()).expect("read");
    assert_eq!(read.runs[1].numbers, recording().runs[1].numbers);
    assert_eq!(read.model_of(&read.runs[0]), read.model);
    let heavy = read.model_of(&read.runs[1]);
    assert_eq!(
        (heavy.inertia, heavy.gravity, heavy.coulomb),
        (1.8e-3, 0.03, 1e-4)
    );
    assert_eq!(read.warnings(), Vec::<String>::new());
}

#[test]
fn numbers_that_no_model_has_are_refused_with_their_line() {
    for (name, value, said) in [
        ("inertai", 1.0, "write `inertia`"),
        ("inertia", -1.0, "runs.1.model.inertia"),
    ] {
        let folder = Folder::empty();
        let mut recording = recording();
        recording.write(folder.path()).expect("written");
        recording.runs[1].numbers = [(name.to_owned(), value)].into();
        let error = recording.write(folder.path()).expect_err(name).to_string();
        assert!(error.contains(said), "{error}");
    }
}
