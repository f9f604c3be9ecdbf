//! Tests of the frequency responses of the filter sections.

use haptic_paddle::estimate::biquad::{SecondOrder, butterworth, first_order};
use haptic_paddle::estimate::low_pass::{self, LowPass};
use std::f64::consts::TAU;

/// Output amplitude for a sine of amplitude 1.
fn gain(cutoff_hz: f32, frequency_hz: f64, tick_s: f32) -> f64 {
    let mut filter = SecondOrder::new(butterworth(cutoff_hz, tick_s));
    let (mut in_phase, mut quadrature, mut samples) = (0.0, 0.0, 0.0);
    let settling = (5.0 / f64::from(cutoff_hz) / f64::from(tick_s)) as usize;
    let periods = (40.0 / frequency_hz / f64::from(tick_s)).round() as usize;
    for tick in 0..settling + periods {
        let phase = TAU * frequency_hz * tick as f64 * f64::from(tick_s);
        let out = f64::from(filter.update(phase.sin() as f32));
        if tick >= settling {
            in_phase += out * phase.sin();
            quadrature += out * phase.cos();
            samples += 0.5;
        }
    }
    in_phase.hypot(quadrature) / samples
}

#[test]
fn the_butterworth_section_is_down_by_3_db_at_its_cutoff() {
    for (cutoff_hz, tick_s) in [
        (10.0, 1e-4),
        (100.0, 1e-4),
        (100.0, 350e-6),
        (1000.0, 350e-6),
    ] {
        let at_cutoff = gain(cutoff_hz, f64::from(cutoff_hz), tick_s);
        assert!(
            (at_cutoff - 0.5_f64.sqrt()).abs() < 5e-3,
            "{cutoff_hz} {tick_s}: {at_cutoff}"
        );
    }
    let decade_above = gain(100.0, 1000.0, 1e-4);
    assert!(decade_above < 0.0101, "{decade_above}");
}

#[test]
fn reset_sets_the_steady_state() {
    let mut filter = SecondOrder::new(butterworth(100.0, 1e-4));
    filter.reset(0.3);
    for _ in 0..1000 {
        assert!((filter.update(0.3) - 0.3).abs() < 1e-5);
    }
}

#[test]
fn a_cutoff_of_0_or_beyond_the_rate_still_gives_a_stable_filter() {
    let mut through = SecondOrder::new(butterworth(0.0, 1e-4));
    assert_eq!(through.update(0.7), 0.7);
    let mut fast = SecondOrder::new(butterworth(1e6, 1e-4));
    for _ in 0..100 {
        fast.update(1.0);
    }
    assert!((fast.update(1.0) - 1.0).abs() < 1e-3);
}

#[test]
fn the_first_order_section_is_the_filter_of_the_lab() {
    for cutoff_hz in [0.0, 10.0, 100.0, 1e6] {
        let gain = low_pass::gain(cutoff_hz, 350e-6);
        let mut section = SecondOrder::new(first_order(gain));
        let mut labs = LowPass::new(gain);
        for tick in 0..2000 {
            let input = (0.01 * tick as f32).sin();
            let difference = section.update(input) - labs.update(input);
            assert!(difference.abs() < 1e-6, "{cutoff_hz}: {difference}");
        }
    }
}

#[test]
fn a_decaying_output_never_becomes_subnormal() {
    for section in [first_order(0.2), butterworth(100.0, 1e-4)] {
        let mut filter = SecondOrder::new(section);
        filter.update(1.0);
        for _ in 0..5000 {
            let output = filter.update(0.0);
            assert!(!output.is_subnormal(), "{output:e}");
        }
        assert!(filter.update(0.0).abs() < 1e-20);
    }
}
