//! Rows that are slow against the springs and dampers of the model, and uneven, leave no gap.

use gap::{Device, Model, Recording, measure};
use host_sim::plant::{Plant, Torque};
use recording::{Drive, Run};
use std::path::Path;

/// A step of the finer solution, s: a twentieth of the fastest time constant.
const FINE_S: f64 = 2e-5;

/// What a device that is exactly `model` leaves in rows of about `row_s`, uneven by a share, whose input is held.
fn recorded(model: Model, row_s: f64, uneven: f64, largest: f64) -> Recording {
    let device = Device::nominal(&model);
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.0, 0.0);
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    for row in 0..400 {
        let turn = f64::from(row);
        let told = largest * (0.21 * turn).sin();
        time.push(state.time_s);
        input.push(told);
        position.push(state.position);
        let lasts_s = row_s * (1.0 + uneven * (12.9 * (1.0 + turn)).sin());
        let steps = (lasts_s / FINE_S).ceil();
        for _ in 0..steps as usize {
            let torque = Torque::held(device.drive.settled(told));
            plant.advance(&mut state, torque, lasts_s / steps);
        }
    }
    let mut recording = Recording::new("stiff", 0.5, model);
    recording
        .runs
        .push(Run::new("run.csv", Drive::OpenLoop, time, input, position));
    recording
}

fn span(recording: &Recording) -> f64 {
    let positions = recording.runs.iter().flat_map(|run| run.position.iter());
    let ends = positions.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(*x), high.max(*x)]
    });
    ends[1] - ends[0]
}

#[test]
fn a_heavily_damped_axis_with_uneven_rows_leaves_its_floor() {
    let model = Model {
        viscous: 2.0,
        ..Model::new(0.005)
    };
    let recording = recorded(model, 0.033, 0.45, 0.6);
    let (gap, _) = measure(&recording, &Device::nominal(&model));
    assert!(gap.before < 0.03 * span(&recording), "{gap:?}");
}

#[test]
fn a_servo_as_spring_and_damper_with_dry_friction_leaves_its_floor() {
    for coulomb in [0.0, 1e-3, 2.0] {
        let model = Model {
            viscous: 20.0,
            stiffness: 50.0,
            ratio: 50.0,
            coulomb,
            ..Model::new(0.0075)
        };
        let recording = recorded(model, 0.02, 0.0, 0.6);
        let (gap, _) = measure(&recording, &Device::nominal(&model));
        assert!(gap.before < 0.03 * span(&recording), "{coulomb}: {gap:?}");
    }
}

#[test]
fn shared_recordings_that_are_stiff_are_at_their_floor() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let shared = std::env::var_os("PADDLE_SHARED").map_or(beside, Into::into);
    for case in ["stiff-jitter", "stiff-servo"] {
        let Ok(recording) = Recording::read(shared.join("cases").join(case)) else {
            println!("skipped: shared_data: no {case} at {}", shared.display());
            continue;
        };
        let (gap, _) = measure(&recording, &Device::nominal(&recording.model));
        println!("{case}: {gap:?}");
        assert!(gap.before < 1.3 * gap.floor, "{case}: {gap:?}");
    }
}
