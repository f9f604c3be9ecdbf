//! Fixtures of the tests: simulated recordings.

use crate::fit::objective::Objective;
use crate::fit::problem::Problem;
use crate::guess::{self, Evidence};
use crate::term::{Coordinate, Term};
use crate::windows::motion::{Motion, Scales};
use crate::windows::series;
use host_sim::device::Device;
use host_sim::drive::DriveLine;
use host_sim::effects::{self, Effect};
use host_sim::plant::Plant;
use host_sim::sensing::Reading;
use host_sim::sensors::Noise;
use recording::{Drive, Model, Recording, Run, Sensor};

const PERIOD_S: f64 = 1e-3;
const RUN_S: f64 = 6.0;
const NOISE: f64 = 1e-4;
const BEGIN: f64 = 0.05;

/// The problem of `recording` with exact model parameters.
pub(crate) fn problem(recording: &Recording) -> Problem<'_> {
    Problem {
        recording,
        series: series::coarse(recording, recording.horizon),
        priors: Vec::new(),
        modelling: 0.0,
        objective: Objective::Robust,
        quarter: None,
    }
}

/// An effect with some free parameters; the others have their default values.
pub(crate) fn term(name: &str, free: &[Coordinate]) -> Term {
    guess::start::term(effects::kind(name).unwrap(), free.to_vec(), &[])
}

/// Applies `evaluate` to the evidence of a recording with some effects. `change` may modify the motions before.
pub(crate) fn seen<T>(
    effects: &[&str],
    change: impl Fn(&mut [Motion]),
    evaluate: impl Fn(&Evidence<'_>) -> T,
) -> T {
    let recording = recording(effects);
    let series = &problem(&recording).series;
    let device = Device::nominal(&recording.model);
    let motion = |s| Motion::of(s, &device, None, recording.restart_half_width);
    let mut motions: Vec<Motion> = series.iter().map(motion).collect();
    change(&mut motions);
    evaluate(&Evidence {
        series,
        motions: &motions,
        scales: &Scales::of(series, &motions, &device, recording.horizon),
        device: &device,
        model: &recording.model,
        cutoff_hz: None,
        window_costs: &[],
    })
}

/// The effect of a text such as `coulomb:level=0.01`, without free parameters.
pub(crate) fn written(effect: &str) -> Term {
    let Effect { kind, values } = effect.parse().unwrap();
    Term {
        values,
        ..term(kind.name, &[])
    }
}

/// Two runs of a paddle under the sum of two sines, with `effects`.
pub(crate) fn recording(effects: &[&str]) -> Recording {
    recorded(effects, 1)
}

/// The recording of [`recording`] with another noise for each `seed`.
pub(crate) fn recorded(effects: &[&str], seed: u64) -> Recording {
    let model = Model {
        viscous: 1.78e-4,
        coulomb: 0.004,
        stiffness: 0.03,
        ratio: 15.0,
        ..Model::new(5.755e-4)
    };
    let mut device = Device::nominal(&model);
    for effect in effects {
        effect.parse::<Effect>().unwrap().install(&mut device);
    }
    let plant = Plant::new(device.mechanics.clone());
    let mut recording = Recording::new("made for a test", 0.3, model);
    let sensor = Sensor {
        noise: NOISE,
        ..Sensor::default()
    };
    recording.sensors.insert("position".into(), sensor);
    let mut noise = Noise::new(seed);
    for run in 0..2 {
        let start_s = f64::from(run) * RUN_S;
        let mut state = plant.state(start_s, BEGIN, 0.0);
        let mut reading = Reading::at_rest(&device.sensing, BEGIN);
        let mut line = DriveLine::at_rest(&device.drive);
        let (mut time, mut input, mut position) = (vec![], vec![], vec![]);
        for i in 0..(RUN_S / PERIOD_S) as usize {
            let t = i as f64 * PERIOD_S;
            let u = 0.0011 * (9.0 * t).sin() + 0.0008 * (4.3 * t + f64::from(run)).cos();
            time.push(start_s + t);
            input.push(u);
            let since_s = if i == 0 { 0.0 } else { PERIOD_S };
            let read = reading.follow(&device.sensing, plant.seen(&state).0, since_s);
            position.push(read + noise.next(NOISE));
            line.command(&device.drive, state.time_s, u, state.velocity);
            line.carry(&plant, &mut state, PERIOD_S);
        }
        let file = format!("run-{run}.csv");
        recording
            .runs
            .push(Run::new(file, Drive::OpenLoop, time, input, position));
    }
    recording
}
