//! Tests of the position regulator against the lab's recursion, and of its extensions.

use haptic_paddle::control::position::{Pid, PidGains};
use haptic_paddle::settings::PidSettings;
use proptest::prelude::*;

const TICK_S: f32 = 350e-6;
const RATIO: f32 = 15.0;
const LIMIT_NM: f32 = 0.0323;

fn gains(kp: f32, ki: f32, kd: f32) -> PidSettings {
    PidSettings {
        kp_nm_per_deg: kp,
        ki_nm_per_deg_s: ki,
        kd_nm_s_per_deg: kd,
        ..PidSettings::default()
    }
}

fn tuned(settings: &PidSettings) -> PidGains {
    PidGains::new(settings, RATIO, LIMIT_NM, TICK_S)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_regulator_equals_the_labs_law_below_saturation(
        kp in 0.0_f64..0.05, ki in 0.0_f64..0.7, kd in 0.0_f64..0.001,
        positions_deg in prop::collection::vec(-2.0_f64..2.0, 5..60), setpoint_deg in -2.0_f64..2.0,
    ) {
        let mut pid = Pid::new(tuned(&gains(kp as f32, ki as f32, kd as f32)));
        let (mut sum_deg_s, mut previous_deg) = (0.0, 0.0);
        for wanted_deg in positions_deg {
            // The change is slow enough that the derivative does not saturate.
            let position_deg = previous_deg + (wanted_deg - previous_deg) * 0.02;
            sum_deg_s += (setpoint_deg - position_deg) * f64::from(TICK_S);
            let rate_deg_s = (position_deg - previous_deg) / f64::from(TICK_S);
            let expected_nm =
                (kp * (setpoint_deg - position_deg) + ki * sum_deg_s - kd * rate_deg_s) / f64::from(RATIO);
            let torque_nm =
                pid.update(setpoint_deg.to_radians() as f32, position_deg.to_radians() as f32, 0.0, 0.0);
            prop_assert!((f64::from(torque_nm) - expected_nm).abs() < 2e-6, "{torque_nm} {expected_nm}");
            previous_deg = position_deg;
        }
    }
}

#[test]
fn a_setpoint_step_gives_no_derivative_kick() {
    let mut pid = Pid::new(tuned(&gains(0.0, 0.0, 0.0008)));
    assert_eq!(pid.update(0.0, 0.0, 0.0, 0.0), 0.0);
    assert_eq!(pid.update(0.17, 0.0, 0.0, 0.0), 0.0);
}

#[test]
fn the_setpoint_weight_does_not_change_the_integral() {
    let settings = PidSettings {
        setpoint_weight: 0.0,
        ..gains(0.01, 0.1, 0.0)
    };
    let mut pid = Pid::new(tuned(&settings));
    let torque_nm = pid.update(0.1, 0.0, 0.0, 0.0);
    let expected_nm = 0.1 * 0.1_f32.to_degrees() * TICK_S / RATIO;
    assert!((torque_nm / expected_nm - 1.0).abs() < 1e-5);
}

#[test]
fn the_derivative_filter_preserves_the_integral_of_the_derivative() {
    let settings = gains(0.0, 0.0, 0.0001);
    let mut plain = Pid::new(tuned(&settings));
    let mut filtered = Pid::new(tuned(&PidSettings {
        derivative_cutoff_hz: 50.0,
        ..settings
    }));
    let (mut plain_sum, mut filtered_sum, mut filtered_peak) = (0.0, 0.0, 0.0_f32);
    for tick in 0..500 {
        let position_rad = if tick < 10 { 0.0 } else { 0.001 };
        plain_sum += plain.update(0.0, position_rad, 0.0, 0.0);
        let torque_nm = filtered.update(0.0, position_rad, 0.0, 0.0);
        filtered_sum += torque_nm;
        filtered_peak = filtered_peak.max(torque_nm.abs());
    }
    assert!((filtered_sum / plain_sum - 1.0).abs() < 1e-3);
    assert!(filtered_peak < 0.2 * plain_sum.abs());
}

#[test]
fn the_integral_does_not_wind_up() {
    let mut pid = Pid::new(tuned(&gains(0.05, 5.0, 0.0)));
    // An error of ten degrees saturates the output immediately, for seven seconds.
    for _ in 0..20_000 {
        assert_eq!(pid.update(0.1745, 0.0, 0.0, 0.0), LIMIT_NM);
    }
    // After an overshoot of one degree the torque changes its sign within 35 ms.
    let ticks = (0..20_000).find(|_| pid.update(0.1745, 0.1745 + 0.01745, 0.0, 0.0) < 0.0);
    assert!(ticks.is_some_and(|ticks| ticks < 100), "{ticks:?}");
}

#[test]
fn a_feed_forward_at_the_limit_stops_the_integral_too() {
    let mut pid = Pid::new(tuned(&gains(0.0, 5.0, 0.0)));
    for _ in 0..1000 {
        pid.update(0.1, 0.0, 0.0, 2.0 * LIMIT_NM);
    }
    assert_eq!(pid.integral_nm(), 0.0);
}

#[test]
fn a_change_of_gains_is_bumpless() {
    let mut pid = Pid::new(tuned(&gains(0.01, 0.1, 0.0003)));
    let mut before_nm = 0.0;
    for tick in 0..200 {
        before_nm = pid.update(0.05, 0.0001 * tick as f32, 0.0, 0.0);
    }
    pid.retune(tuned(&gains(0.04, 0.2, 0.0001)));
    let after_nm = pid.update(0.05, 0.02, 0.0, 0.0);
    let of_one_tick_nm = (0.2 * 0.05 * TICK_S + 0.04 * 0.0001) * 57.3 / RATIO;
    assert!(
        (after_nm - before_nm).abs() < 2.0 * of_one_tick_nm,
        "{before_nm} {after_nm}"
    );
}

#[test]
fn without_integral_action_the_bumpless_offset_decays() {
    let mut pid = Pid::new(tuned(&gains(0.05, 0.28, 0.0)));
    for _ in 0..2000 {
        pid.update(0.01, 0.0, 0.0, 0.0);
    }
    let before_nm = pid.update(0.01, 0.0, 0.0, 0.0);
    pid.retune(tuned(&gains(0.01, 0.0, 0.0)));
    let mut torque_nm = pid.update(0.01, 0.0, 0.0, 0.0);
    assert!(
        (torque_nm / before_nm - 1.0).abs() < 0.01,
        "{before_nm} {torque_nm}"
    );
    for _ in 0..(2.0 / TICK_S) as u32 {
        let next_nm = pid.update(0.01, 0.0, 0.0, 0.0);
        assert!(next_nm <= torque_nm);
        torque_nm = next_nm;
    }
    let proportional_nm = 0.01 * 0.01_f32.to_degrees() / RATIO;
    assert!((torque_nm - proportional_nm).abs() < 1e-8);
}

#[test]
fn a_jump_of_the_measured_position_does_not_jump_the_torque() {
    let mut pid = Pid::new(tuned(&gains(0.05, 0.28, 0.0008)));
    let mut before_nm = 0.0;
    for _ in 0..50 {
        before_nm = pid.update(0.02, 0.01, 0.0, 0.0);
    }
    pid.rebase(0.05);
    let after_nm = pid.update(0.02, 0.05, 0.0, 0.0);
    assert!(
        (after_nm - before_nm).abs() < 2e-5,
        "{before_nm} {after_nm}"
    );
}
