//! Checks a step of 10° with each sensor against the report's specification.

use crate::bench::{Bench, image};

/// Specification: overshoot, rise time, and settling time into ±0.2°.
const OVERSHOOT_DEG: f64 = 2.5;
const RISE_S: f64 = 0.1;
const SETTLING_S: f64 = 0.35;
const BAND_DEG: f64 = 0.2;
const STEP_DEG: f64 = 10.0;

/// Runs steps with these settings and evaluates the true position of the paddle.
fn check(bench: &mut Bench, settings: &[&str]) {
    for setting in settings {
        bench.command(setting);
    }
    bench.command("ref 0");
    bench.run(1.0);
    bench.board.record_steps(true);
    bench.command("step 10");
    bench.run(0.6);
    let steps = bench.board.take_steps();
    bench.board.record_steps(false);
    let start_s = steps[0].time_s;
    let path: Vec<_> = steps
        .iter()
        .map(|step| (step.time_s - start_s, step.position_rad.to_degrees()))
        .collect();
    let first = |reached: f64| {
        path.iter()
            .find(|(_, deg)| *deg >= reached)
            .map(|(s, _)| *s)
    };
    let rise_s = first(0.9 * STEP_DEG).unwrap() - first(0.1 * STEP_DEG).unwrap();
    let highest_deg = path.iter().map(|(_, deg)| *deg).fold(0.0, f64::max);
    let outside = path
        .iter()
        .rev()
        .find(|(_, deg)| (deg - STEP_DEG).abs() > BAND_DEG);
    let settled_s = outside.map_or(0.0, |(s, _)| *s);
    println!(
        "overshoot {:.2}°, rise {:.1} ms, settled {:.1} ms",
        highest_deg - STEP_DEG,
        1e3 * rise_s,
        1e3 * settled_s
    );
    assert!(highest_deg - STEP_DEG <= OVERSHOOT_DEG, "{highest_deg}");
    assert!(rise_s <= RISE_S, "{rise_s}");
    assert!(settled_s <= SETTLING_S, "{settled_s}");
}

#[test]
fn a_step_with_the_encoder_meets_the_specification() {
    let Some(image) = image("step_response_by_the_encoder") else {
        return;
    };
    let mut bench = Bench::armed(image);
    check(&mut bench, &["set kp 0.05", "set ki 0", "set kd 0.0008"]);
    let status = bench.command("status");
    assert!(
        status.contains("overshoot") && status.contains("settled"),
        "{status}"
    );
}

#[test]
fn a_step_with_the_hall_sensor_meets_the_specification() {
    let Some(image) = image("step_response_by_the_hall_sensor") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("disarm");
    bench.command("set estimate.sensor hall");
    bench.run(0.5);
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
    check(&mut bench, &["set kp 0.05", "set ki 0.4", "set kd 0.001"]);
}
