//! Tests the compensation of dry friction for different frictions, and the effect of the observer on the derivative.

use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::{DerivativeSource, Sensor, Settings, VelocitySource};
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::device::Device;
use host_sim::presets;

const STEP_RAD: f32 = 0.087_266;
const TICKS_PER_S: usize = 20_000;
/// One encoder count, rad.
const COUNT_RAD: f64 = 2.094e-4;

/// The fitted paddle with its dry friction scaled by `level`, this static ratio, and its viscous friction scaled by
/// `viscous`.
fn device(level: f64, static_ratio: f64, viscous: f64) -> Device {
    let mut device = presets::refit();
    device.mechanics.friction.level_nm[0] *= level;
    device.mechanics.friction.level_nm[1] *= level;
    device.mechanics.friction.stribeck.ratio = static_ratio;
    device.mechanics.viscous *= viscous;
    device
}

/// Peak-to-peak oscillation in the last of three seconds after a step, rad.
fn swing_rad(device: Device, settings: Settings) -> f64 {
    let setup = LoopSetup::firmware(device, settings, presets::motor());
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position).unwrap();
    let step = Excitation::step(STEP_RAD);
    closed_loop.controller_mut().start(&step).unwrap();
    for _ in 0..2 * TICKS_PER_S {
        closed_loop.tick();
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..TICKS_PER_S {
        let position_rad = closed_loop.tick().position_rad;
        low = low.min(position_rad);
        high = high.max(position_rad);
    }
    assert_eq!(closed_loop.controller().fault(), None);
    high - low
}

fn compensated(source: VelocitySource) -> Settings {
    let mut settings = Settings::default();
    settings.compensation.dry = true;
    settings.compensation.dry_source = source;
    settings
}

#[test]
fn the_default_compensation_causes_no_limit_cycle_for_different_frictions() {
    let default = Settings::default().compensation.dry_source;
    let mut cycles_by_measured = 0;
    for level in [0.0, 0.3, 0.6, 1.0, 1.5, 2.5] {
        for static_ratio in [1.0, 1.08, 1.5, 2.0] {
            for viscous in [0.05, 0.3, 1.0] {
                let paddle = || device(level, static_ratio, viscous);
                let swing = swing_rad(paddle(), compensated(default));
                assert!(
                    swing < COUNT_RAD,
                    "{swing} rad at {level} of the friction, static {static_ratio}, viscous {viscous}"
                );
                let by_measured = swing_rad(paddle(), compensated(VelocitySource::Measured));
                cycles_by_measured += usize::from(by_measured > COUNT_RAD);
            }
        }
    }
    println!("by the measured velocity {cycles_by_measured} of 72 paddles never rest");
    assert!(
        cycles_by_measured > 0,
        "the test would not see a limit cycle"
    );
}

/// Torque noise at rest, N m rms at the motor, overshoot of a step, rad, and settling time to 0.2 degrees, s.
fn figures(sensor: Sensor, derivative: DerivativeSource, inertia: f64) -> (f64, f64, f64) {
    let mut settings = Settings::default();
    settings.estimate.sensor = sensor;
    settings.pid.derivative = derivative;
    let mut paddle = presets::refit();
    paddle.mechanics.inertia *= inertia;
    let setup = LoopSetup::firmware(paddle, settings, presets::motor());
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position).unwrap();
    let mut torques = Vec::new();
    for _ in 0..TICKS_PER_S {
        torques.push(f64::from(closed_loop.tick().acting.torque_nm));
    }
    let mean = torques.iter().sum::<f64>() / torques.len() as f64;
    let squares: f64 = torques.iter().map(|nm| (nm - mean).powi(2)).sum();
    let noise_nm = (squares / torques.len() as f64).sqrt();
    let from_rad = closed_loop.tick().position_rad;
    let step = Excitation::step(STEP_RAD);
    closed_loop.controller_mut().start(&step).unwrap();
    let (mut highest, mut settled_s) = (0.0_f64, 0.0);
    for tick in 0..TICKS_PER_S {
        let moved_rad = closed_loop.tick().position_rad - from_rad;
        highest = highest.max(moved_rad);
        if (moved_rad - f64::from(STEP_RAD)).abs() > 0.2_f64.to_radians() {
            settled_s = tick as f64 / TICKS_PER_S as f64;
        }
    }
    (noise_nm, highest - f64::from(STEP_RAD), settled_s)
}

#[test]
fn the_observers_derivative_reduces_the_noise_and_keeps_the_step_response() {
    for sensor in [Sensor::Encoder, Sensor::Hall] {
        for inertia in [0.7, 1.0, 1.3] {
            let [by_position, by_observer] =
                [DerivativeSource::Position, DerivativeSource::Observer]
                    .map(|source| figures(sensor, source, inertia));
            println!(
                "{sensor:?}, inertia {inertia}: noise {:.3} and {:.3} mN m, overshoot {:.2} and {:.2} deg, settled {:.0} and {:.0} ms",
                1e3 * by_position.0,
                1e3 * by_observer.0,
                by_position.1.to_degrees(),
                by_observer.1.to_degrees(),
                1e3 * by_position.2,
                1e3 * by_observer.2
            );
            if sensor == Sensor::Hall {
                assert!(by_observer.0 < 0.5 * by_position.0, "{by_observer:?}");
            }
            assert!(
                by_observer.1 < by_position.1 + 0.3_f64.to_radians(),
                "{by_observer:?}"
            );
        }
    }
}
