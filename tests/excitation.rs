//! Tests of the excitation signals: spectrum, phase after hours, limits and ends.

use haptic_paddle::excitation::{
    Excitation, ExcitationError, Generator, MULTISINE_HARMONICS, Shape,
};
use std::f64::consts::TAU;

const TICK_S: f32 = 1e-4;

fn excitation(shape: Shape, amplitude: f32, frequency_hz: f32, duration_s: f32) -> Excitation {
    Excitation {
        shape,
        amplitude,
        offset: 0.0,
        frequency_hz,
        end_frequency_hz: 0.0,
        duration_s,
    }
}

fn samples(excitation: &Excitation) -> Vec<f32> {
    let mut generator = Generator::new(excitation, TICK_S).unwrap();
    std::iter::from_fn(|| generator.next(0.0)).collect()
}

/// Amplitude of the signal at one frequency.
fn amplitude(samples: &[f32], frequency_hz: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (tick, sample) in samples.iter().enumerate() {
        let phase = TAU * frequency_hz * tick as f64 * 1e-4;
        re += f64::from(*sample) * phase.cos();
        im += f64::from(*sample) * phase.sin();
    }
    re.hypot(im) * 2.0 / samples.len() as f64
}

#[test]
fn a_sine_is_pure() {
    let sine = samples(&excitation(Shape::Sine, 0.0011, 5.0, 10.0));
    assert_eq!(sine.len(), 100_000);
    assert!((amplitude(&sine, 5.0) / 0.0011 - 1.0).abs() < 1e-4);
    for harmonic in [2.0, 3.0, 5.0, 7.0] {
        assert!(amplitude(&sine, 5.0 * harmonic) < 1e-5 * 0.0011);
    }
}

#[test]
fn a_multisine_has_equal_harmonics_and_the_requested_amplitude() {
    let multisine = samples(&excitation(Shape::Multisine, 1.0, 1.0, 10.0));
    let first = amplitude(&multisine, 1.0);
    for harmonic in 1..=MULTISINE_HARMONICS {
        assert!((amplitude(&multisine, f64::from(harmonic)) / first - 1.0).abs() < 1e-3);
    }
    let peak = multisine.iter().fold(0.0_f32, |peak, x| peak.max(x.abs()));
    assert!(peak <= 1.0 && peak > 0.98, "{peak}");
}

#[test]
fn square_and_triangle_waves_have_their_fourier_coefficients() {
    let square = samples(&excitation(Shape::Square, 1.0, 2.5, 4.0));
    let triangle = samples(&excitation(Shape::Triangle, 1.0, 2.5, 4.0));
    for k in [1.0, 3.0, 5.0] {
        assert!((amplitude(&square, 2.5 * k) / (8.0 / TAU / k) - 1.0).abs() < 2e-3);
        assert!((amplitude(&triangle, 2.5 * k) / (32.0 / TAU / TAU / k / k) - 1.0).abs() < 2e-3);
    }
    assert!(triangle[0].abs() < 1e-6);
    assert!((triangle[1000] - 1.0).abs() < 1e-3);
}

#[test]
fn the_phase_does_not_drift_over_hours() {
    const PERIOD: u64 = 4096;
    const HOURS_OF_TICKS: u64 = 26_000 * PERIOD;
    let frequency_hz = 10_000.0 / PERIOD as f32;
    let mut generator =
        Generator::new(&excitation(Shape::Sine, 1.0, frequency_hz, 0.0), TICK_S).unwrap();
    let mut period = || -> Vec<f32> { (0..PERIOD).map(|_| generator.next(0.0).unwrap()).collect() };
    let first = period();
    for _ in 1..HOURS_OF_TICKS / PERIOD {
        period();
    }
    let later = period();
    // The remaining error is the rounding of the frequency: a constant 6e-8 of it.
    let slip_rad = 6e-8 * TAU * (HOURS_OF_TICKS / PERIOD) as f64;
    let error = first
        .iter()
        .zip(&later)
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max);
    assert!(error < slip_rad + 1e-4, "{error} {slip_rad}");
}

#[test]
fn a_chirp_changes_its_frequency_linearly_without_jumps() {
    let chirp = samples(&Excitation {
        end_frequency_hz: 20.0,
        ..excitation(Shape::Chirp, 1.0, 1.0, 10.0)
    });
    let steepest = chirp
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(0.0, f32::max);
    assert!(steepest < 20.2 * TAU as f32 * TICK_S, "{steepest}");
    let phase = |t: f64| TAU * (t + 19.0 * t * t / 20.0);
    for tick in (0..chirp.len()).step_by(997) {
        let expected = phase(tick as f64 * 1e-4).sin();
        assert!((f64::from(chirp[tick]) - expected).abs() < 0.02, "{tick}");
    }
}

#[test]
fn a_ramp_ends_when_the_paddle_breaks_away_and_reports_the_torque() {
    let ramp = excitation(Shape::Ramp, 0.002, 0.0, 4.0);
    let mut generator = Generator::new(&ramp, TICK_S).unwrap();
    let mut torque_nm = 0.0;
    while let Some(next_nm) = generator.next(if torque_nm > 0.0011 { 0.12 } else { 0.1 }) {
        torque_nm = next_nm;
    }
    assert!((generator.breakaway().unwrap() - 0.0011).abs() < 1e-6);
    assert_eq!(generator.next(0.1), None);

    let mut stuck = Generator::new(&ramp, TICK_S).unwrap();
    assert_eq!(std::iter::from_fn(|| stuck.next(0.0)).count(), 40_000);
    assert_eq!(stuck.breakaway(), None);
}

#[test]
fn invalid_signals_are_refused() {
    let refused = |e: Excitation| Generator::new(&e, TICK_S).unwrap_err();
    assert_eq!(
        refused(excitation(Shape::Sine, f32::NAN, 1.0, 0.0)),
        ExcitationError::BadNumber
    );
    assert_eq!(
        refused(excitation(Shape::Sine, 1.0, 1.0, -1.0)),
        ExcitationError::BadNumber
    );
    assert_eq!(
        refused(excitation(Shape::Sine, 1.0, 0.0, 1.0)),
        ExcitationError::BadFrequency
    );
    assert_eq!(
        refused(excitation(Shape::Square, 1.0, 5000.0, 1.0)),
        ExcitationError::BadFrequency
    );
    assert_eq!(
        refused(excitation(Shape::Multisine, 1.0, 900.0, 1.0)),
        ExcitationError::BadFrequency
    );
    assert_eq!(
        refused(excitation(Shape::Ramp, 1.0, 0.0, 0.0)),
        ExcitationError::NeedsDuration
    );
}
