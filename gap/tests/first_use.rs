//! What a first use on foreign data broke: each test is a wrong answer that was given once.

mod made;

use gap::diagnosis::{Diagnosis, Verdict};
use gap::{Options, Outcome, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use recording::Model;

const NOISE: f64 = 1e-4;

/// A paddle with the effects that are written so, and the nominal model of one without.
fn hidden(effects: &[&str], seed: u64) -> Recording {
    let mut device = Device::nominal(&made::paddle());
    for effect in effects {
        effect.parse::<Effect>().unwrap().install(&mut device);
    }
    made::recorded(&device, made::paddle(), NOISE, 0.0, seed)
}

fn diagnosed(recording: &Recording) -> Outcome {
    diagnose(recording, &Options::default())
}

fn names(diagnosis: &Diagnosis) -> Vec<&'static str> {
    diagnosis.effects.iter().map(|effect| effect.name).collect()
}

#[test]
fn a_number_that_moved_within_its_tolerance_is_said_and_after_is_what_it_leaves() {
    let device = Model {
        coulomb: 0.0065,
        ..made::paddle()
    };
    let mut recording = made::recording(&device, made::paddle(), NOISE, 0.0, 3);
    recording.tolerance.set("coulomb", 0.3);
    let Outcome { diagnosis, model } = diagnosed(&recording);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{diagnosis:?}");
    let number = &diagnosis.numbers[0];
    assert_eq!(number.name, "coulomb");
    assert!((number.found / 0.0065 - 1.0).abs() < 0.05, "{number:?}");
    assert!(
        number
            .sigmas
            .is_some_and(|sigmas| (1.0..2.5).contains(&sigmas)),
        "{number:?}"
    );
    let gap = &diagnosis.gap;
    assert!(gap.after < 0.2 * gap.before, "{gap:?}");
    assert_eq!(model.model.coulomb, number.found);
}

#[test]
fn a_number_that_is_not_stated_is_estimated_and_no_effect() {
    let mut recording = hidden(&["stribeck:static_ratio=1.8"], 4);
    recording.unstated = vec!["ratio", "viscous", "coulomb", "gravity"];
    recording.model = Model::new(recording.model.inertia);
    let Outcome { diagnosis, .. } = diagnosed(&recording);
    let found = |name: &str| {
        let number = diagnosis.numbers.iter().find(|number| number.name == name);
        number.map_or(f64::NAN, |number| number.found)
    };
    let truth = made::paddle();
    for (name, hidden) in [
        ("ratio", truth.ratio),
        ("coulomb", truth.coulomb),
        ("gravity", truth.gravity),
    ] {
        let found = found(name);
        assert!(
            (found / hidden - 1.0).abs() < 0.1,
            "{name}: {found} for {hidden}"
        );
    }
    for name in names(&diagnosis) {
        assert!(
            !["torque_gain", "coulomb", "gravity", "viscous", "compliance"].contains(&name),
            "{name} is named: {diagnosis:?}"
        );
    }
}

#[test]
fn without_an_effect_the_model_that_is_left_is_the_nominal_one_bit_for_bit() {
    let mut recording = hidden(&[], 5);
    // A torque of which the input says nothing.
    for run in &mut recording.runs {
        for (t, x) in run.time.iter().zip(&mut run.position) {
            *x += 0.02 * (37.0 * t).sin() * (1.7 * t).cos();
        }
    }
    recording.tolerance.set("inertia", 0.05);
    let Outcome { diagnosis, model } = diagnosed(&recording);
    if diagnosis.effects.is_empty() && diagnosis.numbers.is_empty() {
        assert_eq!(model.model, recording.model);
        assert_eq!(diagnosis.gap.after, diagnosis.gap.before);
    } else {
        assert!(
            diagnosis.gap.after < diagnosis.gap.before,
            "{:?}",
            diagnosis.gap
        );
    }
}

#[test]
fn a_position_in_another_unit_than_stated_is_said_in_words() {
    let mut recording = hidden(&[], 6);
    recording.runs[0].input.fill(0.0);
    let model = Model {
        coulomb: 0.0,
        viscous: 0.0,
        ..made::paddle()
    };
    // A free swing of some rad is small in degrees, where the model makes another period of it.
    const STEPS: usize = 50;
    let (mut x, mut v) = (1.6, 0.0);
    let run = &mut recording.runs[0];
    for (k, position) in run.position.iter_mut().enumerate() {
        *position = x;
        let next = run.time.get(k + 1).copied().unwrap_or(run.time[k]);
        let dt = (next - run.time[k]) / STEPS as f64;
        for _ in 0..STEPS {
            v -= dt * model.gravity / model.inertia * f64::sin(x);
            x += dt * v;
        }
    }
    recording.units.position = "deg".into();
    recording.model = Model {
        angle_rad: 1f64.to_radians(),
        inertia: model.inertia.to_radians(),
        ..model
    };
    let Outcome { diagnosis, .. } = diagnosed(&recording);
    assert!(
        names(&diagnosis).iter().all(|name| *name != "sensor_gain"),
        "{diagnosis:?}"
    );
}

/// The verdict and the names do not depend on these.
fn same_answer(recording: &Recording, other: &Recording) {
    let [one, other] = [recording, other].map(|r| diagnosed(r).diagnosis);
    assert_eq!(one.verdict, other.verdict);
    assert_eq!(names(&one), names(&other));
}

#[test]
fn the_order_of_runs_and_the_names_of_files_change_nothing() {
    let mut recording = hidden(&["coulomb:level=0.008"], 7);
    let mut second = hidden(&["coulomb:level=0.008"], 8);
    recording.runs.append(&mut second.runs);
    let mut other = recording.clone();
    other.runs.reverse();
    for (k, run) in other.runs.iter_mut().enumerate() {
        run.file = format!("another-{k}.csv");
    }
    same_answer(&recording, &other);
}

#[test]
fn the_sign_of_position_and_input_changes_nothing() {
    let recording = hidden(&["asymmetric_coulomb:positive=0.009,negative=0.004"], 9);
    let mut other = recording.clone();
    for run in &mut other.runs {
        run.position.iter_mut().for_each(|x| *x = -*x);
        run.input.iter_mut().for_each(|u| *u = -*u);
    }
    same_answer(&recording, &other);
}

#[test]
fn the_unit_of_the_position_changes_nothing() {
    let recording = hidden(&["stribeck:static_ratio=1.8"], 10);
    let degrees = 1f64.to_degrees();
    let mut other = recording.clone();
    other.units.position = "deg".into();
    for run in &mut other.runs {
        run.position.iter_mut().for_each(|x| *x *= degrees);
    }
    for sensor in other.sensors.values_mut() {
        sensor.noise *= degrees;
        sensor.resolution *= degrees;
    }
    let model = &mut other.model;
    model.inertia /= degrees;
    model.viscous /= degrees;
    model.stiffness /= degrees;
    model.angle_rad = 1f64.to_radians();
    same_answer(&recording, &other);
}
