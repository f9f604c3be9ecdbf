//! Tests of the step metrics on sequences with known results.

use haptic_paddle::metrics::{StepMetrics, StepReport};

const TICK_S: f32 = 350e-6;
const BAND_DEG: f32 = 0.2;

fn follow(target_deg: f32, positions_deg: impl IntoIterator<Item = f32>) -> StepReport {
    let mut metrics =
        StepMetrics::start(0.0, target_deg.to_radians(), BAND_DEG.to_radians(), TICK_S);
    for position_deg in positions_deg {
        metrics.update(position_deg.to_radians());
    }
    metrics.report()
}

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-5
}

#[test]
fn a_ringing_step_has_the_expected_metrics() {
    // The position crosses 10 at tick 4, peaks at 11.5, and is outside the band for the last time at tick 7.
    let report = follow(
        10.0,
        [0.0, 4.0, 9.0, 9.9, 11.5, 10.5, 9.9, 9.7, 9.9, 10.0, 10.0],
    );
    assert!(close(report.overshoot_rad.to_degrees(), 1.5));
    assert!(close(report.rise_s.unwrap(), 4.0 * TICK_S));
    assert!(close(report.settling_s.unwrap(), 7.0 * TICK_S));
    assert!(close(report.elapsed_s, 11.0 * TICK_S));
}

#[test]
fn a_step_that_never_reaches_the_target_has_no_rise_and_no_settling_time() {
    let report = follow(
        10.0,
        (0..2000).map(|tick| 9.0 * (1.0 - (-0.01 * tick as f32).exp())),
    );
    assert_eq!(report.overshoot_rad, 0.0);
    assert_eq!(report.rise_s, None);
    assert_eq!(report.settling_s, None);
    assert!((report.steady_state_error_rad.to_degrees() - 1.0).abs() < 1e-2);
}

#[test]
fn a_step_may_settle_without_ever_reaching_the_target() {
    let report = follow(
        10.0,
        (0..2000).map(|tick| 9.9 * (1.0 - (-0.01 * tick as f32).exp())),
    );
    assert_eq!(report.rise_s, None);
    // 9.9 (1 - exp(-0.01 n)) = 9.8 at n = 459.5.
    assert!(close(report.settling_s.unwrap(), 459.0 * TICK_S));
}

#[test]
fn a_downward_step_has_the_metrics_of_its_mirror_image() {
    let shape = [0.0, 4.0, 9.0, 9.9, 11.5, 10.5, 9.9];
    let up = follow(10.0, shape);
    let down = follow(-10.0, shape.map(|x: f32| -x));
    assert_eq!(up.overshoot_rad, down.overshoot_rad);
    assert_eq!(up.rise_s, down.rise_s);
    assert_eq!(up.settling_s, down.settling_s);
}
