//! A written recording is read back with identical numbers.

use crate::folder::Folder;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use recording::{Drive, InputSampling, Model, Pid, Recording, Run, Sensor};

const SAMPLES: usize = 20;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3, -1e-9..1e-9, Just(-0.0), Just(5e-324), Just(1e20)]
}

fn column() -> impl Strategy<Value = Vec<f64>> {
    vec(number(), SAMPLES)
}

fn narrow() -> impl Strategy<Value = Option<Vec<f32>>> {
    option::of(vec(-1e3..1e3_f32, SAMPLES))
}

prop_compose! {
    fn model()(numbers in vec(1e-6..1e3, Model::NAMES.len()), limit in option::of(1.0..1e3), travel in option::of(1e21..1e22)) -> Model {
        let mut model = Model { input_limit: limit, travel: travel.map(|high| [-1e21, high]), ..Model::new(1.0) };
        for (name, value) in Model::NAMES.into_iter().zip(numbers) {
            let _ = model.set(name, value);
        }
        // The constant input is within the limit.
        Model { input_limit: limit, ..model }
    }
}

prop_compose! {
    fn pid()(kp in number(), ki in number(), kd in number(), period in 1e-5..1.0, position_cutoff_hz in option::of(1.0..1e3)) -> Pid {
        Pid { kp, ki, kd, period, position_cutoff_hz }
    }
}

prop_compose! {
    fn run()(
        start in -1e3..1e3, steps in vec(1e-4..1e-1, SAMPLES), mut position in column(),
        setpoint in option::of(column()), hall in column(), narrow in [narrow(), narrow(), narrow()],
        controller in option::of(pid()), input_time_std in 0.0..1.0, closed in any::<bool>(),
        sampled in any::<bool>(),
    ) -> Run {
        let time = steps.iter().scan(start, |time, step| { *time += step; Some(*time) }).collect();
        // With a constant input the units cannot be judged. Other tests cover that.
        let input = vec![0.1; SAMPLES];
        // The first sample equals the second one. Other tests cover outliers there.
        position[0] = position[1];
        let drive = if closed { Drive::ClosedLoop } else { Drive::OpenLoop };
        let mut run = Run::new("a.csv", drive, time, input, position);
        run.positions.insert("position_hall".into(), hall);
        [run.current, run.supply, run.temperature] = narrow;
        let input_sampling = if sampled { InputSampling::Point } else { InputSampling::Mean };
        Run { setpoint, controller, input_time_std, input_sampling, ..run }
    }
}

prop_compose! {
    fn recording()(
        title in "\\PC{0,20}", model in model(), run in run(), tolerance in 0.0..1.0,
        sensor in (0.0..1.0, 0.0..1.0, option::of(1.0..1e3)),
    ) -> Recording {
        let mut recording = Recording::new(title, 0.5 * run.duration_s(), model);
        recording.tolerance.set("inertia", tolerance);
        recording.tolerance.set("travel", tolerance / 3.0);
        let (resolution, noise, cutoff_hz) = sensor;
        recording.sensors.insert("position".into(), Sensor { resolution, noise, cutoff_hz });
        recording.sensors.insert("position_hall".into(), Sensor::default());
        recording.runs = vec![run.clone(), Run { file: "sub/b.csv".into(), ..run }];
        recording
    }
}

proptest! {
    #[test]
    fn reading_gives_what_was_written(recording in recording()) {
        let folder = Folder::empty();
        recording.write(folder.path()).unwrap();
        let read = folder.read().unwrap();
        prop_assert_eq!(&read.folder, folder.path());
        let found = Recording { folder: recording.folder.clone(), oddities: Vec::new(), ..read };
        prop_assert_eq!(found, recording);
    }
}

#[test]
fn a_number_that_is_not_stated_stays_unstated_when_the_recording_is_written_again() {
    let rows: String = (0..400)
        .map(|k| {
            format!(
                "{},{},{}\n",
                0.001 * f64::from(k),
                f64::from(k % 7),
                (0.03 * f64::from(k)).sin()
            )
        })
        .collect();
    let folder = Folder::empty().with("a.csv", format!("time,input,position\n{rows}")).with(
        "recording.toml",
        "format = 1\nhorizon = 0.2\n[model]\ninertia = 1e-3\nviscous = 0.0\n[[runs]]\nfile = \"a.csv\"\ndrive = \"open-loop\"\n",
    );
    let read = folder.read().unwrap();
    assert_eq!(read.unstated, ["ratio", "coulomb", "gravity"]);
    let copy = Folder::empty();
    read.write(copy.path()).unwrap();
    let again = copy.read().unwrap();
    assert_eq!((again.unstated, again.model), (read.unstated, read.model));
}
