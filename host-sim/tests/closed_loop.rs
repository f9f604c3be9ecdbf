//! Properties of the closed loop that hold for any gains.

use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::safety::Fault;
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::closed_loop::{ClosedLoop, LoopSetup, Rates};
use host_sim::experiment::{Experiment, ExperimentError, Trace, recording};
use host_sim::motor::Motor;
use host_sim::paddle::{Actuator, Command};
use host_sim::plant::Mechanics;
use host_sim::presets;
use recording::Recording;

const STEP_RAD: f32 = 0.174_533;

fn step_for(setup: &LoopSetup, duration_s: f64) -> Trace {
    let mut closed_loop = ClosedLoop::new(setup).unwrap();
    let experiment = Experiment::position(Excitation::step(STEP_RAD), duration_s);
    experiment.run(&mut closed_loop).unwrap()
}

fn ideal() -> LoopSetup {
    LoopSetup::ideal(presets::refit(), Settings::default())
}

fn firmware() -> LoopSetup {
    LoopSetup::firmware(presets::refit(), Settings::default(), presets::motor())
}

fn last(column: &[f64]) -> f64 {
    *column.last().unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_does_not() {
    let mut setup = firmware();
    setup.settings.estimate.sensor = Sensor::Hall;
    let first = step_for(&setup, 0.3);
    assert_eq!(first, step_for(&setup, 0.3));
    setup.paddle.seed = 1;
    assert_ne!(first.position_rad, step_for(&setup, 0.3).position_rad);
}

#[test]
fn a_duty_acts_one_tick_after_the_sample_that_it_was_computed_from() {
    let ticks = |setup: &LoopSetup| {
        let mut closed_loop = ClosedLoop::armed(setup, Mode::Position).unwrap();
        let step = Excitation::step(STEP_RAD);
        closed_loop.controller_mut().start(&step).unwrap();
        [(); 3].map(|()| closed_loop.tick())
    };
    // The step is requested at the first sample.
    let [first, second, third] = ticks(&firmware());
    assert_eq!(first.acting, Command::default());
    assert_eq!(second.position_rad, 0.0);
    assert!(second.acting.duty.0 > 0.2 && second.acting.torque_nm > 0.03);
    assert!(third.position_rad > 0.0);
    let [first, second, _] = ticks(&ideal());
    assert!(first.acting.torque_nm > 0.03 && second.position_rad > 0.0);
}

#[test]
fn the_logged_input_is_the_mean_torque_until_the_next_row() {
    // A free inertia: the change of its velocity over the rows is the integral of the logged torque.
    let mut setup = ideal();
    let inertia = presets::nominal().inertia;
    setup.paddle.device.mechanics = Mechanics::inertia(inertia);
    let rates = setup.rates;
    let mut closed_loop = ClosedLoop::new(&setup).unwrap();
    let experiment = Experiment {
        log_hz: 500.0,
        ..Experiment::torque(Excitation::sine(2e-3, 5.0), 0.1)
    };
    let trace = experiment.run(&mut closed_loop).unwrap();
    let row_s = trace.time_s[1] - trace.time_s[0];
    assert!((row_s - 6.0 * rates.tick_s).abs() < 1e-9);
    let impulse: f64 = trace.input_nm.iter().map(|nm| 15.0 * nm * row_s).sum();
    let gained = closed_loop.paddle().velocity_rad_s();
    assert!((gained - impulse / inertia).abs() < 1e-9, "{gained}");
}

#[test]
fn without_damping_the_loop_oscillates_with_the_period_of_the_log() {
    let mut settings = Settings::default();
    settings.pid.kd_nm_s_per_deg = 0.0;
    let mut setup = LoopSetup::ideal(presets::refit(), settings);
    setup.rates = Rates {
        tick_s: 351e-6,
        ..Rates::LAB
    };
    let trace = step_for(&setup, 2.0);
    let middle = f64::from(STEP_RAD);
    let upward: Vec<f64> = (1..trace.len())
        .filter(|&i| trace.position_rad[i - 1] < middle && trace.position_rad[i] >= middle)
        .map(|i| trace.time_s[i])
        .collect();
    // Friction stops it after 18 periods. The mean of the first 20 periods in the log is 86.85 ms.
    let period_ms = 1e3 * (upward[10] - upward[0]) / 10.0;
    assert!((period_ms / 86.8 - 1.0).abs() < 0.01, "{period_ms} ms");
}

#[test]
fn the_loop_works_with_either_sensor() {
    for sensor in [Sensor::Encoder, Sensor::Hall] {
        for mut setup in [ideal(), firmware()] {
            setup.settings.estimate.sensor = sensor;
            setup.settings.pid.ki_nm_per_deg_s = 0.28;
            let trace = step_for(&setup, 1.0);
            assert_eq!(trace.fault, None);
            let error_deg = (last(&trace.position_rad) - f64::from(STEP_RAD)).to_degrees();
            assert!(error_deg.abs() < 0.2, "{sensor:?}: {error_deg}°");
        }
    }
}

#[test]
fn the_bridge_produces_the_commanded_torque() {
    // Both simulations use the same rates, so only winding and current loop differ.
    let bridge = step_for(&firmware(), 0.5);
    let mut setup = ideal();
    setup.rates = Rates::FIRMWARE;
    let exact = step_for(&setup, 0.5);
    let furthest_deg = bridge
        .position_rad
        .iter()
        .zip(&exact.position_rad)
        .map(|(a, b)| (a - b).abs().to_degrees())
        .fold(0.0, f64::max);
    assert!(furthest_deg < 0.25, "{furthest_deg}°");
    assert!(furthest_deg > 0.0);
}

#[test]
fn a_reversed_motor_is_stopped() {
    let mut setup = firmware();
    // Reverses torque and current as seen by the core.
    setup.paddle.actuator = Actuator::Bridge(Motor {
        supply_v: -24.0,
        ..presets::motor()
    });
    let trace = step_for(&setup, 1.0);
    let (_, fault) = trace.fault.unwrap();
    assert!(
        matches!(fault, Fault::Overcurrent | Fault::Travel | Fault::Overspeed),
        "{fault}"
    );
}

#[test]
fn the_loop_starts_without_a_jump_at_any_position() {
    for (start_rad, encoder_count) in [(0.3, u32::MAX - 5), (-0.2, 1 << 31)] {
        let mut setup = firmware();
        setup.paddle.device.mechanics.gravity = 0.0;
        setup.paddle.start_rad = start_rad;
        setup.paddle.encoder_count = encoder_count;
        let mut closed_loop = ClosedLoop::new(&setup).unwrap();
        let experiment = Experiment {
            excitation: None,
            ..Experiment::position(Excitation::step(0.0), 0.1)
        };
        let trace = experiment.run(&mut closed_loop).unwrap();
        assert!(trace.position_rad.iter().all(|x| *x == start_rad));
        assert!((trace.encoder_rad[0] - start_rad).abs() < 1e-6);
    }
}

#[test]
fn sensing_effects_act_on_the_sensor_that_feeds_the_regulator() {
    for sensor in [Sensor::Encoder, Sensor::Hall] {
        let mut setup = ideal();
        setup.settings.estimate.sensor = sensor;
        setup.settings.pid.ki_nm_per_deg_s = 0.28;
        setup.paddle.device.sensing.gain = 1.2;
        let trace = step_for(&setup, 1.0);
        let [regulating, other] = match sensor {
            Sensor::Encoder => [&trace.encoder_rad, &trace.hall_rad],
            Sensor::Hall => [&trace.hall_rad, &trace.encoder_rad],
        };
        assert!((last(regulating) / last(&trace.position_rad) - 1.2).abs() < 0.02);
        assert!((last(other) / last(&trace.position_rad) - 1.0).abs() < 0.02);
    }
}

#[test]
fn successive_experiments_continue_the_same_session() {
    let mut setup = ideal();
    setup.paddle.start_s = 3.0;
    let mut closed_loop = ClosedLoop::new(&setup).unwrap();
    let experiment = Experiment::position(Excitation::step(0.05), 0.2);
    let first = experiment.run(&mut closed_loop).unwrap();
    let second = experiment.run(&mut closed_loop).unwrap();
    assert_eq!(first.time_s[0], 3.0);
    assert!(second.time_s[0] > last(&first.time_s));
    assert!(last(&second.position_rad) > last(&first.position_rad) + 0.03);
}

#[test]
fn an_impossible_experiment_is_refused() {
    let mut closed_loop = ClosedLoop::new(&ideal()).unwrap();
    let good = Experiment::position(Excitation::step(0.05), 0.2);
    for (experiment, message) in [
        (
            Experiment {
                duration_s: f64::NAN,
                ..good
            },
            "duration",
        ),
        (
            Experiment {
                duration_s: 0.0,
                ..good
            },
            "duration",
        ),
        (
            Experiment {
                log_hz: 0.0,
                ..good
            },
            "log rate",
        ),
        (
            Experiment {
                log_hz: 1.0,
                ..good
            },
            "log rate",
        ),
        (
            Experiment {
                reference: Some(9.0),
                ..good
            },
            "limit.travel",
        ),
    ] {
        let refused: ExperimentError = experiment.run(&mut closed_loop).unwrap_err();
        assert!(refused.to_string().contains(message), "{refused}");
    }
}

#[test]
fn a_recording_reads_back_with_its_sensors_and_its_controller() {
    let setup = ideal();
    let trace = step_for(&setup, 0.5);
    let mut made = recording("a step", 0.25, presets::nominal(), &setup);
    made.runs.push(trace.to_run("step.csv", &setup));
    let folder = std::env::temp_dir().join(format!("host-sim-recording-{}", std::process::id()));
    made.write(&folder).unwrap();
    let read = Recording::read(&folder).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(read.runs, made.runs);
    assert_eq!(read.sensors, made.sensors);

    // The stated controller is the control law in use: kp times the first error equals the first torque.
    let pid = read.runs[0].controller.unwrap();
    assert!((pid.kp - 0.191).abs() < 1e-3 && (pid.kd - 0.00306).abs() < 1e-5);
    let quantum = std::f64::consts::TAU / 30_000.0;
    for x in &read.runs[0].position {
        assert!((x / quantum - (x / quantum).round()).abs() < 1e-3);
    }
}
