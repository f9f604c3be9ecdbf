//! Compares the simulation with the same control core on a plant with 64 times finer steps.

use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::drive::Drive;
use host_sim::plant::{Plant, Torque};
use host_sim::presets;

const FINER: u32 = 64;
const DURATION_S: f64 = 2.0;
const BAR_DEG: f64 = 1e-6;

/// Position, rad, and commanded torque, N m at the motor, at each tick of a 10° step.
fn step(setup: &LoopSetup) -> (Vec<f64>, Vec<f64>) {
    let mut closed_loop = ClosedLoop::armed(setup, Mode::Position).unwrap();
    let step = Excitation::step(10f32.to_radians());
    closed_loop.controller_mut().start(&step).unwrap();
    let ticks = (DURATION_S / setup.rates.tick_s) as usize;
    (0..ticks)
        .map(|_| {
            let tick = closed_loop.tick();
            (tick.position_rad, f64::from(tick.acting.torque_nm))
        })
        .unzip()
}

fn rms_deg(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt().to_degrees()
}

fn error_deg(mut setup: LoopSetup) -> f64 {
    let coarse = step(&setup).0;
    setup.paddle.parts_per_tick *= FINER;
    rms_deg(&coarse, &step(&setup).0)
}

fn ideal() -> LoopSetup {
    LoopSetup::ideal(presets::refit(), Settings::default())
}

fn firmware() -> LoopSetup {
    LoopSetup::firmware(presets::refit(), Settings::default(), presets::motor())
}

#[test]
fn replaying_the_torque_gives_the_same_positions() {
    let setup = ideal();
    let told = step(&setup).1;
    let drive = Drive::ideal(15.0);
    let replay = |parts: u32| {
        let plant = Plant::new(setup.paddle.device.mechanics.clone());
        let mut state = plant.state(0.0, 0.0, 0.0);
        let mut path = Vec::new();
        for input in &told {
            path.push(state.position);
            for _ in 0..parts {
                let part_s = setup.rates.tick_s / f64::from(parts);
                plant.advance(&mut state, Torque::held(drive.settled(*input)), part_s);
            }
        }
        path
    };
    let error = rms_deg(&replay(1), &replay(FINER));
    println!("replay {error:e}");
    assert!(error < BAR_DEG, "{error:e}°");
}

#[test]
fn the_closed_loop_at_350_us_matches_the_finer_simulation() {
    let error = error_deg(ideal());
    println!("ideal {error:e}");
    assert!(error < BAR_DEG, "{error:e}°");
}

#[test]
fn the_closed_loop_with_current_loop_matches_the_finer_simulation() {
    let error = error_deg(firmware());
    println!("bridge {error:e}");
    assert!(error < BAR_DEG, "{error:e}°");
}
