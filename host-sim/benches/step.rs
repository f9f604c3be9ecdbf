//! Speed of the simulation of a 10° step of 2 s with stick, slip and a quantised encoder.
//!
//! One element is one simulated second, so elements per second are multiples of real time.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::plant::{Plant, Torque};
use host_sim::presets;

const SIMULATED_S: u64 = 2;

fn stepping(setup: &LoopSetup) -> ClosedLoop {
    let mut closed_loop = ClosedLoop::armed(setup, Mode::Position).expect("starts at 0");
    let step = Excitation::step(10f32.to_radians());
    closed_loop.controller_mut().start(&step).expect("armed");
    closed_loop
}

fn ticks(setup: &LoopSetup) -> usize {
    (SIMULATED_S as f64 / setup.rates.tick_s) as usize
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    group.throughput(Throughput::Elements(SIMULATED_S));
    let lab = LoopSetup::ideal(presets::refit(), Settings::default());

    let drive = lab.paddle.device.drive.clone();
    let mut recorded = stepping(&lab);
    let torques: Vec<f64> = (0..ticks(&lab))
        .map(|_| drive.settled(f64::from(recorded.tick().acting.torque_nm)))
        .collect();
    let plant = Plant::new(lab.paddle.device.mechanics.clone());
    group.bench_function("replayed torque", |bencher| {
        bencher.iter(|| {
            let mut state = plant.state(0.0, 0.0, 0.0);
            for &torque_nm in &torques {
                plant.advance(&mut state, Torque::held(torque_nm), lab.rates.tick_s);
            }
            state
        });
    });

    let firmware = LoopSetup::firmware(presets::refit(), Settings::default(), presets::motor());
    for (name, setup) in [
        ("closed loop at 350 us", &lab),
        ("closed loop with current loop at 50 us", &firmware),
    ] {
        let ticks = ticks(setup);
        group.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                || stepping(setup),
                |closed_loop| {
                    for _ in 0..ticks {
                        closed_loop.tick();
                    }
                },
                BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
