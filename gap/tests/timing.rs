//! How `input` was sampled, and when it acts, is read as it is stated; where the data say otherwise, a warning does.

use gap::diagnosis::{Diagnosis, Verdict};
use gap::{Device, Model, Options, Recording, diagnose, measure};
use host_sim::plant::{Plant, Torque};
use host_sim::sensors::Noise;
use recording::{Drive, InputSampling, Run, Sensor};
use std::path::Path;

/// From row to row, s, and steps of the motion in it.
const ROW_S: f64 = 0.016;
const STEPS: usize = 32;
const NOISE: f64 = 1e-4;

fn pendulum() -> Model {
    Model {
        viscous: 0.05,
        gravity: 4.0,
        coulomb: 0.1,
        ..Model::new(0.08)
    }
}

fn torque(t: f64) -> f64 {
    1.5 * (7.0 * t).sin() + 1.2 * (19.0 * t).cos() + 0.9 * (31.0 * t).sin()
}

/// A pendulum that is exactly its model under a smooth torque, of which each row has what `told` says of its beginning and end, s.
fn recorded(told: impl Fn(f64, f64) -> f64) -> Recording {
    recorded_of(&pendulum(), told)
}

/// A recording of `device`, with the pendulum as the nominal model.
fn recorded_of(device: &Model, told: impl Fn(f64, f64) -> f64) -> Recording {
    let device = Device::nominal(device);
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.0, 0.0);
    let mut noise = Noise::new(4);
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    let step_s = ROW_S / STEPS as f64;
    for row in 0..750 {
        let start_s = row as f64 * ROW_S;
        time.push(start_s);
        input.push(told(start_s, start_s + ROW_S));
        position.push(state.position + noise.next(NOISE));
        for step in 0..STEPS {
            let acting = torque(start_s + (step as f64 + 0.5) * step_s);
            plant.advance(&mut state, Torque::held(acting), step_s);
        }
    }
    let mut recording = Recording::new("timing", 0.3, pendulum());
    let sensor = Sensor {
        noise: NOISE,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), sensor);
    recording
        .runs
        .push(Run::new("run.csv", Drive::OpenLoop, time, input, position));
    recording
}

fn at_the_row(start_s: f64, _: f64) -> f64 {
    torque(start_s)
}

fn until_the_next(start_s: f64, end_s: f64) -> f64 {
    let step_s = (end_s - start_s) / STEPS as f64;
    let steps = (0..STEPS).map(|step| torque(start_s + (step as f64 + 0.5) * step_s));
    steps.sum::<f64>() / STEPS as f64
}

fn diagnosed(recording: &Recording) -> (Diagnosis, Option<String>) {
    let diagnosis = diagnose(recording, &Options::default()).diagnosis;
    let mut warnings = diagnosis.warnings.iter();
    let timing = warnings
        .find(|line| line.contains("the data prefer"))
        .cloned();
    (diagnosis, timing)
}

#[test]
fn an_input_sampled_at_instants_is_told_from_a_mean_and_leaves_no_gap_once_it_is_stated() {
    let mut recording = recorded(at_the_row);
    let (_, warning) = diagnosed(&recording);
    let warning = warning.expect("sampled at instants, stated as a mean");
    assert!(warning.contains("input_sampling = \"point\""), "{warning}");
    let nominal = Device::nominal(&pendulum());
    let (as_mean, _) = measure(&recording, &nominal);
    recording.runs[0].input_sampling = InputSampling::Point;
    let (gap, _) = measure(&recording, &nominal);
    assert!(
        gap.before < 1.3 * gap.floor && gap.before < 0.3 * as_mean.before,
        "{gap:?} {as_mean:?}"
    );
    let (diagnosis, warning) = diagnosed(&recording);
    assert_eq!((diagnosis.verdict, warning), (Verdict::NoGap, None));
}

#[test]
fn a_mean_input_that_is_stated_as_one_brings_no_warning() {
    let mut recording = recorded(until_the_next);
    let (diagnosis, warning) = diagnosed(&recording);
    assert_eq!((diagnosis.verdict, warning), (Verdict::NoGap, None));
    recording.runs[0].input_sampling = InputSampling::Point;
    let (_, warning) = diagnosed(&recording);
    let warning = warning.expect("a mean, stated as sampled at instants");
    assert!(warning.contains("mean until the next"), "{warning}");
}

#[test]
fn an_uncertain_time_of_the_input_is_estimated() {
    const LATE_S: f64 = 0.006;
    let mut recording = recorded(|from, to| until_the_next(from + LATE_S, to + LATE_S));
    let (diagnosis, warning) = diagnosed(&recording);
    assert_ne!(diagnosis.verdict, Verdict::NoGap);
    let warning = warning.expect("an input that is late");
    assert!(warning.contains("later"), "{warning}");
    recording.runs[0].input_time_std = 0.005;
    let (diagnosis, warning) = diagnosed(&recording);
    assert_eq!((diagnosis.verdict, warning), (Verdict::NoGap, None));
}

#[test]
fn a_column_that_is_a_row_late_does_not_hide_what_else_is_missing() {
    let rubbing = Model {
        coulomb: 0.3,
        ..pendulum()
    };
    let recording = recorded_of(&rubbing, |from, to| {
        until_the_next(from - ROW_S, to - ROW_S)
    });
    let outcome = diagnose(&recording, &Options::default());
    let found = outcome.diagnosis;
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name).collect();
    assert_eq!(names, ["coulomb"], "{:?}", found.numbers);
    let delay = found.numbers.iter().find(|number| number.name == "delay");
    let delay_s = delay.map_or(0.0, |number| number.found);
    assert!((delay_s + ROW_S).abs() < 0.05 * ROW_S, "{delay_s} s");
    assert!(found.gap.after < 0.1 * found.gap.before, "{:?}", found.gap);
    let (corrected, _) = measure(&recording, &outcome.model.device());
    assert!(corrected.before < 1.5 * found.gap.after, "{corrected:?}");
}

#[test]
fn shared_recordings_whose_timing_is_as_stated_bring_no_warning() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let shared = std::env::var_os("PADDLE_SHARED").map_or(beside, Into::into);
    for case in ["stiff-jitter", "stiff-servo"] {
        let Ok(recording) = Recording::read(shared.join("cases").join(case)) else {
            println!("skipped: shared_data: no {case} at {}", shared.display());
            continue;
        };
        let (_, warning) = diagnosed(&recording);
        assert_eq!(warning, None, "{case}");
    }
}
