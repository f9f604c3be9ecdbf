//! The missing torque of devices whose truth is known.

use gap::missing_torque::Axis;
use gap::{Device, Effect, MissingTorque};
use host_sim::drive::DriveLine;
use host_sim::plant::Plant;
use host_sim::sensors::Noise;
use recording::{Drive, Model, Recording, Run, Sensor};
use std::f64::consts::TAU;

const PERIOD_S: f64 = 1e-3;
const NOISE: f64 = 1e-4;

/// A motor that swings freely about a weak spring, with its own friction.
fn motor() -> Model {
    Model {
        viscous: 2e-4,
        coulomb: 0.004,
        stiffness: 0.02,
        ratio: 15.0,
        ..Model::new(5.755e-4)
    }
}

/// `seconds` of a motor with effects that its model does not know, under a torque of some frequencies that depend on the seed.
fn recorded(model: Model, effects: &[String], seconds: f64, torque: f64, seed: u64) -> Recording {
    let mut device = Device::nominal(&model);
    for effect in effects {
        let effect: Effect = effect.parse().expect("an effect");
        effect.install(&mut device);
    }
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.05, 0.0);
    let mut line = DriveLine::at_rest(&device.drive);
    let mut random = Noise::new(seed);
    let stretch = 1.0 + 0.02 * (seed % 13) as f64;
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    for i in 0..(seconds / PERIOD_S) as u32 {
        let t = f64::from(i) * PERIOD_S;
        let w = stretch * t;
        let wave = (9.0 * w).sin() + 0.8 * (3.7 * w).cos() + 0.6 * (14.9 * w + 1.0).sin();
        let u = torque / 15.0 * wave / 1.5;
        time.push(t);
        input.push(u);
        position.push(state.position + random.next(NOISE));
        line.command(&device.drive, state.time_s, u, state.velocity);
        line.carry(&plant, &mut state, PERIOD_S);
    }
    let mut recording = Recording::new("made for a test", 0.3, model);
    let sensor = Sensor {
        noise: NOISE,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), sensor);
    let run = Run::new("run.csv", Drive::OpenLoop, time, input, position);
    recording.runs.push(run);
    recording
}

fn missing(recording: &Recording) -> MissingTorque {
    MissingTorque::of(recording, &Device::nominal(&recording.model))
}

#[test]
fn a_friction_that_the_model_lacks_is_estimated_within_its_band() {
    let recording = recorded(motor(), &["coulomb:level=0.012".into()], 6.0, 0.05, 1);
    let missing = missing(&recording);
    let run = &missing.runs()[0];
    // Away from reversals it is 8 mN m, of one sign or the other.
    let size = |i: usize| run.torque[i].abs();
    let sizes: Vec<f64> = (0..run.torque.len()).step_by(50).map(size).collect();
    let near = sizes
        .iter()
        .filter(|size| (*size - 0.008).abs() < 0.0015)
        .count();
    assert!(
        3 * near > 2 * sizes.len(),
        "{near} of {}: {sizes:.4?}",
        sizes.len()
    );
    let std = run.std.iter().sum::<f64>() / run.std.len() as f64;
    assert!((2e-4..3e-3).contains(&std), "{std}");
}

#[test]
fn orders_of_a_ripple_are_found_with_their_amplitudes() {
    let orders = [(4.0, 0.006), (8.0, 0.004), (12.0, 0.003), (24.0, 0.002)];
    let mut wrong = Vec::new();
    for seed in 1..=20 {
        let mut recording = recorded_with_ripple(&orders, seed);
        recording.model.coulomb = 0.0;
        let found = missing(&recording).ripple();
        for (wave_number, amplitude) in orders {
            let near = |n: f64| (n - wave_number).abs() < 0.03 * wave_number;
            let order = found.iter().find(|order| near(order.wave_number));
            let off = order.map_or(1.0, |order| (order.amplitude / amplitude - 1.0).abs());
            if off > 0.1 {
                wrong.push((seed, wave_number, amplitude, order.copied()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A motor with friction of 5 mN m and waves over its position, of which each is pushed as a torque of its own.
fn recorded_with_ripple(orders: &[(f64, f64)], seed: u64) -> Recording {
    let model = Model {
        coulomb: 0.005,
        stiffness: 0.0,
        ..motor()
    };
    let plant = Plant::new(Device::nominal(&model).mechanics);
    let mut state = plant.state(0.0, 0.0, 0.0);
    let mut random = Noise::new(seed);
    let phase = |k: usize| TAU * ((seed as f64) * 0.377 + 0.21 * k as f64).fract();
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    let fine = 10;
    for i in 0..20_000 {
        let t = f64::from(i) * PERIOD_S;
        let u = (0.03 * (2.1 * t).sin() + 0.01 * (5.3 * t + 0.1 * seed as f64).cos()) / 15.0;
        time.push(t);
        input.push(u);
        position.push(state.position + random.next(NOISE));
        for _ in 0..fine {
            let waves = orders.iter().enumerate();
            let ripple: f64 = waves
                .map(|(k, (n, a))| a * (n * state.position + phase(k)).sin())
                .sum();
            let torque = host_sim::plant::Torque::held(15.0 * u + ripple);
            plant.advance(&mut state, torque, PERIOD_S / f64::from(fine));
        }
    }
    let mut recording = Recording::new("a ripple", 0.3, model);
    let sensor = Sensor {
        noise: NOISE,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), sensor);
    let run = Run::new("run.csv", Drive::OpenLoop, time, input, position);
    recording.runs.push(run);
    recording
}

#[test]
fn the_axis_of_a_single_effect_comes_first() {
    let cases = [
        ("coulomb:level=0.015", Axis::Velocity),
        ("viscous:coefficient=0.002", Axis::Velocity),
        (
            "asymmetric_coulomb:positive=0.012,negative=0.004",
            Axis::Velocity,
        ),
        ("quadratic_drag:coefficient=0.0004", Axis::Velocity),
        ("stribeck:static_ratio=3,velocity=1", Axis::Velocity),
        ("spring:stiffness=0.05,zero=0.2", Axis::Position),
        ("gravity:weight=0.02,zero=0.5", Axis::Position),
        (
            "cogging:amplitude=0.006,wave_number=5,phase=0.4",
            Axis::Position,
        ),
        (
            "end_stop:lower=-9,upper=0.5,stiffness=0.1,damping=0",
            Axis::Position,
        ),
        ("torque_gain:gain=1.3", Axis::Input),
        ("deadband:width=0.001", Axis::Input),
        ("saturation:limit=0.002", Axis::Input),
    ];
    let (mut right, mut all, mut wrong) = (0, 0, Vec::new());
    for (effect, axis) in cases {
        for seed in 1..=5 {
            let recording = recorded(motor(), &[effect.into()], 8.0, 0.05, seed);
            let look = missing(&recording).look(None);
            all += 1;
            if look.summary.shares[0].axis == axis {
                right += 1;
            } else {
                wrong.push((effect, look.summary.shares));
            }
        }
    }
    assert!(10 * right >= 9 * all, "{right} of {all}: {wrong:.2?}");
}

#[test]
fn a_single_effect_is_among_the_first_proposals_with_its_size() {
    let recording = recorded(
        motor(),
        &["viscous:coefficient=0.0022".into()],
        8.0,
        0.05,
        3,
    );
    let list = missing(&recording).shortlist(4);
    let found = list.iter().find(|set| set.names() == ["viscous"]);
    let found = found.unwrap_or_else(|| panic!("{list:?}"));
    let coefficient = found.effects[0].1[0];
    assert!((coefficient - 0.0022).abs() < 1e-4, "{coefficient}");
    assert!(found.share > 0.95, "{}", found.share);
}

#[test]
fn a_motion_that_only_repeats_itself_is_said_to() {
    let mut recording = recorded(motor(), &["viscous:coefficient=0.002".into()], 8.0, 0.05, 0);
    assert!(!missing(&recording).look(None).summary.repeats);
    let run = &mut recording.runs[0];
    for i in 0..run.len() {
        let t = run.time[i];
        run.position[i] = 0.3 * (TAU * t).sin();
        run.input[i] = 0.001 * (TAU * t).cos();
    }
    assert!(missing(&recording).look(None).summary.repeats);
}

#[test]
fn what_shows_nothing_gives_an_answer_without_a_panic() {
    let mut recording = recorded(motor(), &[], 1.0, 0.05, 1);
    recording.runs[0].position.fill(0.3);
    let look = missing(&recording).look(None);
    assert!(look.summary.rms.is_finite(), "{:?}", look.summary);
    recording.runs[0] = recording.runs[0].part(0..12);
    assert!(missing(&recording).look(None).summary.rms.is_finite());
    recording.runs.clear();
    assert!(missing(&recording).look(None).points.is_empty());
}

#[test]
fn of_a_long_recording_stretches_are_looked_at_that_are_spread_over_all_of_it() {
    const SECONDS: f64 = 300.0;
    let recording = recorded(motor(), &["coulomb:level=0.012".into()], SECONDS, 0.05, 5);
    let runs = missing(&recording).runs();
    let times: Vec<&[f64]> = runs.iter().map(|run| &run.time_s[..]).collect();
    let [time_s] = times[..] else {
        panic!("{} runs", runs.len());
    };
    let step_s = time_s[1] - time_s[0];
    let looked_at_s = time_s.len() as f64 * step_s;
    assert!(
        (0.5 * SECONDS..0.8 * SECONDS).contains(&looked_at_s),
        "{looked_at_s} s"
    );
    let [first_s, last_s] = [time_s[0], time_s[time_s.len() - 1]];
    assert!(
        first_s < 0.1 * SECONDS && last_s > 0.9 * SECONDS,
        "{first_s} s to {last_s} s"
    );
}
