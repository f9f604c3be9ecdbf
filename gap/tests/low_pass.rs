//! A column that a low-pass has already gone over.

mod made;

use gap::diagnosis::Verdict;
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
    let mut recording = recording(&paddle(), nominal, first, 0.0, seed);
    let sensor = recording.sensors.get_mut("position").unwrap();
    sensor.noise = NOISE;
    sensor.cutoff_hz = Some(CUTOFF_HZ);
    let run = &mut recording.runs[0];
    let gain = low_pass_gain(Some(CUTOFF_HZ), run.time[1] - run.time[0]);
    let mut random = Noise::new(seed ^ 0xff);
    let mut passed = run.position[0];
    for position in &mut run.position {
        passed += gain * (*position - passed);
        *position = passed + random.next(NOISE - first);
    }
    recording
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

#[test]
fn samples_that_are_put_together_are_predicted_as_they_are() {
    let recording = low_passed(paddle(), false, 3);
    let predictor = gap::predict::Predictor::new(Device::nominal(&paddle()), &recording);
    let whole = &gap::series::full(&recording, 0.3)[0];
    let coarse = &gap::series::coarse(&recording, 0.3)[0];
    let all = predictor.predict(whole);
    let group = whole.time.len() / coarse.time.len();
    assert_eq!(group, 2);
    for (means, p) in all.chunks(group).zip(predictor.predict(coarse)) {
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        assert!((p - mean).abs() < 0.2 * NOISE, "{p} {mean}");
    }
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
