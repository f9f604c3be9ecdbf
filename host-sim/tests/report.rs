//! The step responses of the report's table 1 on the fitted paddle, with the lab's true period of 351 µs.

use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::ClosedLoop;
use host_sim::presets;

fn step(kp: f32, ki: f32, kd: f32, seconds: f64) -> ClosedLoop {
    let mut settings = Settings::default();
    settings.pid.kp_nm_per_deg = kp;
    settings.pid.ki_nm_per_deg_s = ki;
    settings.pid.kd_nm_s_per_deg = kd;
    let setup = presets::lab(settings);
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Position).unwrap();
    let controller = closed_loop.controller_mut();
    controller
        .start(&Excitation::step(10f32.to_radians()))
        .unwrap();
    for _ in 0..(seconds / setup.rates.tick_s) as usize {
        closed_loop.tick();
    }
    closed_loop
}

#[test]
fn the_step_responses_match_an_independent_simulation() {
    // Overshoot, rise time and settling time of an independent simulation of the same paddle, in degrees and ms.
    let rows = [
        ((0.05, 0.0, 0.0003), (4.71, 26.3, None)),
        ((0.05, 0.0, 0.0008), (0.61, 38.9, Some(76.0))),
        ((0.05, 0.2857, 0.0008), (1.72, 34.0, Some(322.0))),
    ];
    for ((kp, ki, kd), (overshoot_deg, rise_ms, settling_ms)) in rows {
        let report = step(kp, ki, kd, 1.0).controller().metrics().unwrap();
        let overshoot = report.overshoot_rad.to_degrees();
        assert!((overshoot - overshoot_deg).abs() < 0.1, "{overshoot}°");
        let rise = report.rise_s.unwrap() * 1e3;
        assert!((rise / rise_ms - 1.0).abs() < 0.04, "{rise} ms");
        if let Some(settling_ms) = settling_ms {
            let settling = report.settling_s.unwrap() * 1e3;
            assert!((settling / settling_ms - 1.0).abs() < 0.05, "{settling} ms");
        }
    }
}

#[test]
fn a_weak_loop_never_reaches_the_target() {
    let report = step(0.01, 0.0, 0.0003, 1.0).controller().metrics().unwrap();
    assert_eq!((report.overshoot_rad, report.rise_s), (0.0, None));
}
