//! Compares the import of the lab's logs with recordings made by hand.

use import::{Imported, PidLaw, Recipe, SwitchOn, import, read_log};
use recording::{Recording, Run};
use std::path::{Path, PathBuf};

fn lab(test: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/epfl-paddle");
    if folder.is_dir() {
        return Some(folder);
    }
    println!(
        "skipped: shared_data: {test}: there is no {}",
        folder.display()
    );
    None
}

fn imported(folder: &Path, files: &[&str], recipe: &Recipe) -> Imported {
    let logs: Vec<_> = files
        .iter()
        .map(|file| read_log(&folder.join("raw").join(file)).expect("a log"))
        .collect();
    import(&logs, recipe).expect("imported")
}

fn assert_like(found: &Run, wanted: &Run, columns: [f64; 2]) {
    assert_eq!(found.len(), wanted.len(), "{}", found.file);
    let worst = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let off = [
        worst(&found.time, &wanted.time),
        worst(&found.input, &wanted.input),
        worst(&found.position, &wanted.position),
    ];
    assert!(
        off[0] < 1e-9 && off[1] < columns[0] && off[2] < columns[1],
        "{}: off by {off:?}",
        found.file
    );
}

#[test]
fn the_sine_is_what_was_made_by_hand() {
    let Some(folder) = lab("sine") else { return };
    let recipe = Recipe {
        input: Some("0.0011*sin(2*3.14*timestamp):Nm".into()),
        position: Some("paddle_pos_filt".into()),
        tick_s: Some(0.00035),
        undo_low_pass_hz: Some(100.0),
        ..Recipe::default()
    };
    let found = imported(&folder, &["SimVsReal/sine_real_0011.csv.gz"], &recipe);
    let wanted = Recording::read(folder.join("sine-0011")).expect("a recording");
    // The last row lasts one tick here.
    assert_like(&found.recording.runs[0], &wanted.runs[0], [1e-6, 1e-7]);
}

fn steps(on: Vec<SwitchOn>) -> Recipe {
    Recipe {
        position: Some("paddle_pos_filt".into()),
        setpoint: Some("Target_Angle".into()),
        pid: Some(PidLaw {
            kp: "Kp/15".into(),
            ki: "Ki/15".into(),
            kd: "Kd/15".into(),
            limit: Some(0.0323),
            on,
        }),
        tick_s: Some(0.00035),
        undo_low_pass_hz: Some(100.0),
        keep_s: Some([-0.15, 0.6]),
        horizon_s: Some(0.1),
        ..Recipe::default()
    }
}

const STEPS: [&str; 3] = [
    "PID_Encoder/p01i0d0003.csv.gz",
    "PID_Encoder/p05i0d0003.csv.gz",
    "PID_Encoder/p05i0d0008.csv.gz",
];
/// Times at which the controllers were switched on, from the recording made by hand, s.
const ON_S: [f64; 3] = [906.28615, 867.24505, 815.5602];

#[test]
fn the_steps_are_what_was_made_by_hand() {
    let Some(folder) = lab("steps") else { return };
    let found = imported(&folder, &STEPS, &steps(ON_S.map(SwitchOn::At).into()));
    let wanted = Recording::read(folder.join("steps-encoder")).expect("a recording");
    for (found, wanted) in found.recording.runs.iter().zip(&wanted.runs) {
        assert_like(found, wanted, [1e-8, 1e-7]);
        let (found, wanted) = (
            found.controller.expect("a law"),
            wanted.controller.expect("a law"),
        );
        assert!(
            (found.kp / wanted.kp - 1.0).abs() < 1e-6 && (found.kd / wanted.kd - 1.0).abs() < 1e-6,
            "{found:?}"
        );
    }
}

#[test]
fn when_a_controller_was_switched_on_is_found_within_two_ticks() {
    let Some(folder) = lab("switching on") else {
        return;
    };
    let found = imported(&folder, &STEPS, &steps(vec![SwitchOn::Found]));
    let wanted = Recording::read(folder.join("steps-encoder")).expect("a recording");
    let first = |run: &Run| {
        run.input
            .iter()
            .position(|input| *input != 0.0)
            .map(|row| run.time[row])
    };
    for (found, wanted) in found.recording.runs.iter().zip(&wanted.runs) {
        // Both start 0.15 s earlier.
        let rows = first(found).zip(first(wanted)).map(|(a, b)| (a - b).abs());
        assert!(
            rows.is_some_and(|off| off < 1.2e-3),
            "{}: {rows:?}",
            found.file
        );
    }
}
