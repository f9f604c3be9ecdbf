//! A column that a low-pass has already gone over.

mod made;

use gap::diagnosis::Verdict;
use gap::predict::Predictor;
use gap::series::Series;
use gap::{Options, diagnose};
use host_sim::device::Device;
use host_sim::sensors::Noise;
use made::{paddle, recording};
use recording::{Model, Recording, low_pass_gain};

const CUTOFF_HZ: f64 = 60.0;
const NOISE: f64 = 1e-4;

/// What the paddle shows behind a low-pass that comes before its noise or after it.
fn low_passed(nominal: Model, noise_first: bool, seed: u64) -> Recording {
    let first = if noise_first { NOISE } else { 0.0 };
    let recording = recording(&paddle(), nominal, first, 0.0, seed);
    passed(recording, CUTOFF_HZ, NOISE - first, seed)
}

/// A recording whose column a low-pass has gone over before `noise` was added.
fn passed(mut recording: Recording, cutoff_hz: f64, noise: f64, seed: u64) -> Recording {
    let sensor = recording.sensors.get_mut("position").unwrap();
    sensor.noise = NOISE;
    sensor.cutoff_hz = Some(cutoff_hz);
    let run = &mut recording.runs[0];
    let gain = low_pass_gain(Some(cutoff_hz), run.time[1] - run.time[0]);
    let mut random = Noise::new(seed ^ 0xff);
    let mut passed = run.position[0];
    for position in &mut run.position {
        passed += gain * (*position - passed);
        *position = passed + random.next(noise);
    }
    recording
}

#[test]
fn a_jump_of_the_counter_is_found_at_its_height_behind_a_slow_low_pass() {
    const JUMPED_S: f64 = 3.1;
    const HEIGHT: f64 = 0.1;
    let mut recording = recording(&paddle(), paddle(), 0.0, 0.0, 1);
    let run = &mut recording.runs[0];
    for (position, time) in run.position.iter_mut().zip(&run.time) {
        *position += if *time < JUMPED_S { 0.0 } else { HEIGHT };
    }
    let recording = passed(recording, 14.0, NOISE, 1);
    let diagnosis = diagnose(&recording, &Options::default()).diagnosis;
    let effect = &diagnosis.effects[0];
    assert_eq!(effect.name, "lost_counts");
    let number = |name: &str| effect.parameters[name].value;
    let [time, height] = [number("time"), number("jump")];
    // Its first sample shows a twentieth of it.
    assert!((time - JUMPED_S).abs() < 2e-3, "{time}");
    assert!((height / HEIGHT - 1.0).abs() < 0.2, "{height}");
}

#[test]
fn a_perfect_model_is_at_the_floor_wherever_the_noise_comes_in() {
    for noise_first in [true, false] {
        let ratios = (0..16).map(|seed| {
            let recording = low_passed(paddle(), noise_first, seed);
            let (gap, _) = gap::measure(&recording, &Device::nominal(&paddle()));
            (gap.before / gap.floor).powi(2)
        });
        let ratio = (ratios.sum::<f64>() / 16.0).sqrt();
        assert!((1.0..1.3).contains(&ratio), "{noise_first}: {ratio}");
    }
}

/// How far the prediction of samples that are put together, so many at a time, lies beside the mean of that of each, at most.
fn beside_means(recording: &Recording, together: &[Series], group: usize) -> f64 {
    let predictor = Predictor::new(Device::nominal(&paddle()), recording);
    let whole = &gap::series::full(recording, recording.horizon)[0];
    assert_eq!(whole.time.len() / together[0].time.len(), group);
    let all = predictor.predict(whole);
    let means = all.chunks(group);
    let means = means.map(|all| all.iter().sum::<f64>() / all.len() as f64);
    let pairs = means.zip(predictor.predict(&together[0]));
    pairs.fold(0.0, |most, (mean, p)| (p - mean).abs().max(most))
}

#[test]
fn samples_that_are_put_together_are_predicted_as_they_are() {
    let recording = low_passed(paddle(), false, 3);
    let fine = gap::series::some_fine(&recording, recording.horizon, usize::MAX);
    assert!(beside_means(&recording, &fine, 2) < 0.2 * NOISE);
}

#[test]
fn a_low_pass_takes_nothing_from_samples_that_are_farther_apart() {
    let beside_means = |recording: &Recording| {
        let coarse = gap::series::coarse(recording, recording.horizon);
        beside_means(recording, &coarse, 4)
    };
    let passed = beside_means(&low_passed(paddle(), false, 3));
    let seen = beside_means(&recording(&paddle(), paddle(), NOISE, 0.0, 3));
    // A break-away is known to the time between inputs.
    assert!(seen < 0.4 * NOISE, "{seen}");
    assert!(passed < 1.05 * seen, "{passed} {seen}");
}

#[test]
fn the_low_pass_is_no_finding() {
    for noise_first in [true, false] {
        let right = low_passed(paddle(), noise_first, 5);
        let said = diagnose(&right, &Options::default()).diagnosis;
        assert_eq!(said.verdict, Verdict::NoGap);
        let nominal = Model {
            coulomb: 0.008,
            ..paddle()
        };
        let wrong = low_passed(nominal, noise_first, 5);
        let said = diagnose(&wrong, &Options::default()).diagnosis;
        let names: Vec<&str> = said.effects.iter().map(|e| e.name).collect();
        assert_eq!(
            (said.verdict, &names[..]),
            (Verdict::Explained, &["coulomb"][..])
        );
    }
}
