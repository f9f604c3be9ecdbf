//! Diagnoses of 20 s with static friction that the nominal model does not know, and what they spend on each stage.

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use gap::recording::{Drive, Run, Sensor};
use gap::{Effect, Options, Recording, Stage, diagnose};
use host_sim::device::Device;
use host_sim::drive::DriveLine;
use host_sim::plant::Plant;
use host_sim::presets;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Mutex;
use std::time::{Duration, Instant};

const SECONDS: f64 = 20.0;
const RATES_HZ: [f64; 2] = [1000.0, 3000.0];
const HORIZON_S: f64 = 0.25;
/// Lines that share no period: amplitude at the motor, N m, and frequency, Hz.
const LINES: [(f64, f64); 4] = [
    (1.6e-3, 0.53),
    (1.2e-3, 1.31),
    (0.9e-3, 2.77),
    (0.6e-3, 6.1),
];
/// Of the encoder, rad.
const RESOLUTION: f64 = TAU / 2000.0 / 15.0;
const HIDDEN: &str = "stribeck:static_ratio=1.6,velocity=0.3";

fn recording(rate_hz: f64) -> Recording {
    let model = presets::nominal();
    let mut device = Device::nominal(&model);
    let hidden: Effect = HIDDEN.parse().expect("an effect of the vocabulary");
    hidden.install(&mut device);
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.0, 0.0);
    let mut line = DriveLine::at_rest(&device.drive);
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    for row in 0..(SECONDS * rate_hz) as u32 {
        let now_s = f64::from(row) / rate_hz;
        let told: f64 = LINES
            .iter()
            .map(|(a, hz)| a * (TAU * hz * now_s).sin())
            .sum();
        time.push(now_s);
        input.push(told);
        position.push((plant.seen(&state).0 / RESOLUTION).round() * RESOLUTION);
        line.command(&device.drive, state.time_s, told, state.velocity);
        line.carry(&plant, &mut state, 1.0 / rate_hz);
    }
    let mut recording = Recording::new("Made for timing", HORIZON_S, model);
    let encoder = Sensor {
        resolution: RESOLUTION,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), encoder);
    recording.tolerance.set("inertia", 0.02);
    recording.tolerance.set("coulomb", 0.05);
    recording
        .runs
        .push(Run::new("log.csv", Drive::OpenLoop, time, input, position));
    recording
}

/// When the stages of the latest diagnosis began.
static BEGUN: Mutex<Vec<(Stage, Instant)>> = Mutex::new(Vec::new());

fn begun() -> std::sync::MutexGuard<'static, Vec<(Stage, Instant)>> {
    BEGUN.lock().expect("nothing panics while it is held")
}

/// Adds what the latest diagnosis spent on each stage.
fn add_spent(spent: &mut BTreeMap<Stage, Duration>) {
    let begun = std::mem::take(&mut *begun());
    let ends = begun
        .iter()
        .skip(1)
        .map(|(_, at)| *at)
        .chain([Instant::now()]);
    for ((stage, start), end) in begun.iter().zip(ends) {
        *spent.entry(*stage).or_default() += end - *start;
    }
}

fn diagnoses(criterion: &mut Criterion) {
    let options = Options {
        progress: |stage| begun().push((stage, Instant::now())),
        ..Options::default()
    };
    let mut group = criterion.benchmark_group("20 s");
    // A diagnosis takes seconds: as few as the statistics allow.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for rate_hz in RATES_HZ {
        let rate = format!("{rate_hz} Hz");
        let made = recording(rate_hz);
        let folder =
            std::env::temp_dir().join(format!("gap-bench-{}-{rate_hz}", std::process::id()));
        made.write(&folder)
            .expect("the folder for temporary files can be written");
        group.bench_function(BenchmarkId::new("read", &rate), |bencher| {
            bencher.iter(|| Recording::read(&folder).expect("written above"));
        });
        // Left-over temporary files do no harm.
        let _ = std::fs::remove_dir_all(&folder);

        let mut spent = BTreeMap::new();
        let mut count = 0;
        group.bench_function(BenchmarkId::new("diagnose", &rate), |bencher| {
            bencher.iter(|| {
                let outcome = diagnose(&made, &options);
                add_spent(&mut spent);
                count += 1;
                outcome
            });
        });
        for (stage, whole) in spent {
            println!(
                "    {:8.3} s  {stage}",
                whole.as_secs_f64() / f64::from(count)
            );
        }
        println!();
    }
    group.finish();
}

criterion_group!(benches, diagnoses);
criterion_main!(benches);
