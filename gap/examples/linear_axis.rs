//! Another device: a carriage on a rail, driven by a linear motor, with far more friction than its data sheet says.
//!
//! `cargo run --release --example linear_axis`

use gap::recording::{Drive, Run, Sensor};
use gap::{Device, Effect, Model, Options, Recording, diagnose, measure};

const RATE_HZ: f64 = 1000.0;
const SAMPLES: i32 = 6000;
/// Of the encoder, m.
const RESOLUTION: f64 = 5e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let data_sheet = Model {
        viscous: 3.0,      // N s/m
        ratio: 40.0,       // N/A
        ..Model::new(2.0)  // kg
    };
    let mut recording = Recording::new("Carriage", 0.25, data_sheet);
    recording.units.position = "m".into();
    recording.units.input = "A".into();
    let encoder = Sensor {
        resolution: RESOLUTION,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), encoder);
    recording.tolerance.set("inertia", 0.01);
    recording.runs.push(measured());

    let (nominal, _) = measure(&recording, &Device::nominal(&data_sheet));
    println!(
        "gap {:.2e} m, floor {:.2e} m",
        nominal.before, nominal.floor
    );

    let mut device = Device::nominal(&data_sheet);
    "viscous:coefficient=5"
        .parse::<Effect>()?
        .install(&mut device);
    let (by_hand, _) = measure(&recording, &device);
    println!("with 5 N s/m, tried by hand: {:.2e} m", by_hand.before);

    let diagnosis = diagnose(&recording, &Options::default()).diagnosis;
    println!(
        "{:?}: gap after {:.2e} m",
        diagnosis.verdict, diagnosis.gap.after
    );
    for effect in &diagnosis.effects {
        println!("{} ({:.0} % sure)", effect.name, 100.0 * effect.confidence);
        for (name, number) in &effect.parameters {
            let std = number
                .std
                .map_or(String::new(), |std| format!(" ± {std:.3}"));
            println!("  {name} = {:.3}{std} {}", number.value, number.unit);
        }
    }
    Ok(())
}

/// What a log of the real carriage would hold; here it has 8 N s/m.
fn measured() -> Run {
    let (mut x, mut v) = (0.0, 0.0);
    let (mut time, mut input, mut position) = (Vec::new(), Vec::new(), Vec::new());
    for sample in 0..SAMPLES {
        let now = f64::from(sample) / RATE_HZ;
        let current = 1.5 * (7.0 * now).sin() + 0.8 * (19.3 * now + 1.0).sin();
        time.push(now);
        input.push(current);
        position.push((x / RESOLUTION).round() * RESOLUTION);
        for _ in 0..STEPS {
            v += (40.0 * current - 8.0 * v) / 2.0 / RATE_HZ / f64::from(STEPS);
            x += v / RATE_HZ / f64::from(STEPS);
        }
    }
    Run::new("log.csv", Drive::OpenLoop, time, input, position)
}

/// Of the stand-in for reality, a sample.
const STEPS: i32 = 50;
