//! Recordings of a paddle whose truth is known.

use host_sim::device::Device;
use host_sim::drive::DriveLine;
use host_sim::plant::Plant;
use host_sim::sensing::Reading;
use host_sim::sensors::Noise;
use recording::{Drive, Model, Recording, Run, Sensor};

const PERIOD_S: f64 = 5e-4;

pub fn paddle() -> Model {
    Model {
        viscous: 1.78e-4,
        coulomb: 0.004,
        gravity: 0.01464,
        ratio: 15.0,
        ..Model::new(5.755e-4)
    }
}

/// What a device that is exactly `model` leaves in a recording whose nominal model is `nominal`.
pub fn recording(
    model: &Model,
    nominal: Model,
    noise: f64,
    resolution: f64,
    seed: u64,
) -> Recording {
    recorded(&Device::nominal(model), nominal, noise, resolution, seed)
}

/// Six seconds of `device` under two sines, with noise and quantising in rad.
pub fn recorded(
    device: &Device,
    nominal: Model,
    noise: f64,
    resolution: f64,
    seed: u64,
) -> Recording {
    let plant = Plant::new(device.mechanics.clone());
    let mut state = plant.state(0.0, 0.05, 0.0);
    let mut line = DriveLine::at_rest(&device.drive);
    let mut reading = Reading::at_rest(&device.sensing, 0.05);
    let mut random = Noise::new(seed);
    let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
    for i in 0..12_000 {
        let t = f64::from(i) * PERIOD_S;
        let u = 0.0015 * (11.0 * t).sin() + 0.0012 * (4.3 * t).cos();
        let shown = reading.follow(&device.sensing, plant.seen(&state).0, PERIOD_S);
        let seen = shown + random.next(noise);
        time.push(t);
        input.push(u);
        position.push(if resolution > 0.0 {
            (seen / resolution).round() * resolution
        } else {
            seen
        });
        line.command(&device.drive, state.time_s, u, state.velocity);
        line.carry(&plant, &mut state, PERIOD_S);
    }
    let mut recording = Recording::new("made for a test", 0.3, nominal);
    recording.sensors.insert(
        "position".into(),
        Sensor {
            resolution,
            noise,
            cutoff_hz: None,
        },
    );
    recording
        .runs
        .push(Run::new("run.csv", Drive::OpenLoop, time, input, position));
    recording
}
