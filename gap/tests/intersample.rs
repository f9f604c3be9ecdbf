//! A log that is slower than its loop averages what the loop told; what that hides is no finding.

use gap::diagnosis::{Diagnosis, Verdict};
use gap::{Device, Model, Options, Recording, diagnose};
use host_sim::plant::{Plant, Torque};
use host_sim::sensors::Noise;
use recording::{Drive, Pid, Run};

const LOOP_S: f64 = 3.5e-4;
const TICKS_A_ROW: usize = 3;
const HORIZON_S: f64 = 0.29;

/// A paddle whose loop chatters between the limits of a motor that hardly overcomes the friction.
fn paddle() -> Model {
    Model {
        coulomb: 0.004,
        ratio: 15.0,
        input_limit: Some(1e-3),
        ..Model::new(6.8e-4)
    }
}

fn chattering(device: &Device) -> Recording {
    let pid = Pid {
        kp: 0.08,
        ki: 0.0,
        kd: 0.001,
        period: LOOP_S,
        position_cutoff_hz: None,
    };
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.0, 0.0);
    let mut noise = Noise::new(3);
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    let mut before = 0.0;
    for tick in 0..20_000 {
        let now_s = tick as f64 * LOOP_S;
        let measured = plant.seen(&state).0 + noise.next(1.6e-4);
        let setpoint = 0.1 * (5.0 * now_s).sin();
        let told = pid.kp * (setpoint - measured) - pid.kd * (measured - before) / pid.period;
        before = measured;
        if tick % TICKS_A_ROW == 0 {
            time.push(now_s);
            position.push(measured);
            input.push(0.0);
        }
        if let Some(mean) = input.last_mut() {
            *mean += told / TICKS_A_ROW as f64;
        }
        plant.advance(&mut state, Torque::held(device.drive.settled(told)), LOOP_S);
    }
    let mut recording = Recording::new("chattering", HORIZON_S, paddle());
    let mut run = Run::new("run.csv", Drive::ClosedLoop, time, input, position);
    run.controller = Some(pid);
    recording.runs.push(run);
    recording
}

fn diagnosed(model: &Model) -> Diagnosis {
    diagnose(&chattering(&Device::nominal(model)), &Options::default()).diagnosis
}

#[test]
fn what_the_averaged_input_hides_is_no_gap() {
    let diagnosis = diagnosed(&paddle());
    let gap = &diagnosis.gap;
    assert!(gap.before < 1.5 * gap.floor, "{gap:?}");
    assert_eq!(diagnosis.verdict, Verdict::NoGap);
}

#[test]
fn what_is_more_than_that_is_one() {
    let heavier = Model {
        inertia: 1.5 * paddle().inertia,
        ..paddle()
    };
    assert_ne!(diagnosed(&heavier).verdict, Verdict::NoGap);
}
