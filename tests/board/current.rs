//! Tests of the current measurement with faults of amplifier, converter and wires.

use crate::bench::{Bench, image, setup};
use host_sim::device::Device;
use host_sim::presets;
use virtual_board::board::Bridge;
use virtual_board::wiring::{AmplifierFaults, Wires};

/// Torque constant of the motor, N m/A.
const TORQUE_CONSTANT: f64 = 0.0538;

/// A bench with the refitted paddle and this fault of the current amplifier.
fn bench(test: &str, amplifier: AmplifierFaults) -> Option<Bench> {
    let mut bench = Bench::new(image(test)?);
    bench.board.wiring_mut().amplifier = amplifier;
    Some(bench)
}

/// A blocked paddle, so that the torque causes no motion.
fn held() -> Device {
    let mut device = presets::refit();
    device.mechanics.friction.level_nm = [2.0, 2.0];
    device
}

/// Mean torque of the motor over the next 0.1 s, N m.
fn torque_nm(bench: &mut Bench) -> f64 {
    bench.board.record_steps(true);
    bench.run(0.1);
    let steps = bench.board.take_steps();
    bench.board.record_steps(false);
    steps.iter().map(|step| step.torque_nm).sum::<f64>() / steps.len() as f64
}

#[test]
fn the_bridge_s_interference_with_the_amplifier_causes_no_torque() {
    let amplifier = AmplifierFaults {
        common_mode_a: 0.024,
        ..AmplifierFaults::default()
    };
    let Some(mut bench) = bench("what_the_bridge_does_to_the_amplifier", amplifier) else {
        return;
    };
    bench.boot();
    bench.command("zero hall");
    let armed = bench.command("arm torque");
    assert!(armed.contains("mode torque"), "{armed}");
    bench.run(0.5);
    let torque_nm = torque_nm(&mut bench);
    println!("{:.3} mN m at a reference of 0", 1e3 * torque_nm);
    assert!(torque_nm.abs() < 0.1e-3, "{torque_nm}");
}

#[test]
fn calibration_waits_until_the_amplifier_has_settled() {
    let amplifier = AmplifierFaults {
        warm_up_a: 0.05,
        warm_up_s: 0.05,
        ..AmplifierFaults::default()
    };
    let Some(mut bench) = bench("an_amplifier_that_warms_up", amplifier) else {
        return;
    };
    bench.boot();
    let status = bench.command("status");
    let current = status.split("current ").nth(1).unwrap();
    let current_a: f64 = current.split(' ').next().unwrap().parse().unwrap();
    assert!(current_a.abs() < 0.002, "{status}");
}

#[test]
fn an_offset_beyond_the_component_tolerances_prevents_arming() {
    for (name, amplifier) in [
        (
            "0.1 A",
            AmplifierFaults {
                offset_a: 0.1,
                ..AmplifierFaults::default()
            },
        ),
        (
            "wander",
            AmplifierFaults {
                wander_a: 0.03,
                ..AmplifierFaults::default()
            },
        ),
    ] {
        let Some(mut bench) = bench("an_offset_beyond_the_parts_tolerances", amplifier) else {
            return;
        };
        let greeting = bench.boot();
        assert!(greeting.contains("current amplifier"), "{name}: {greeting}");
        bench.command("zero hall");
        for line in ["arm", "arm torque"] {
            let refusal = bench.command(line);
            assert!(refusal.contains("current amplifier"), "{name}: {refusal}");
        }
        assert_eq!(bench.board.bridge(), Bridge::Off);
    }
}

#[test]
fn a_reading_at_either_rail_has_its_own_fault() {
    for rail in [0.0, 4095.0] {
        let Some(image) = image("a_reading_at_either_rail") else {
            return;
        };
        let mut bench = Bench::armed(image);
        bench.command("ref 0");
        bench.board.wiring_mut().amplifier.stuck_counts = Some(rail);
        bench.run(150e-6);
        assert_eq!(bench.board.bridge(), Bridge::Off, "{rail} counts");
        let said = bench.wait_for("> ");
        assert!(said.contains("end of its range"), "{rail} counts: {said}");
    }
}

#[test]
fn no_current_limit_exceeds_the_measuring_range() {
    let Some(image) = image("no_limit_of_the_current_is_beyond") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    for line in ["set limit.current 1.6", "set limit.current 3.3"] {
        let refusal = bench.command(line);
        assert!(refusal.contains("must be a number from"), "{refusal}");
    }
    assert!(bench.command("get limit.current").contains("= 1.5 A"));
}

/// Runs until the bridge is off. Returns the time in s and the largest torque in N m.
fn until_off(bench: &mut Bench) -> (f64, f64) {
    const PATIENCE_S: f64 = 0.1;
    let from_s = bench.board.time_s();
    let mut largest_nm = 0.0_f64;
    while bench.drives() {
        bench.run(50e-6);
        largest_nm = largest_nm.max(bench.board.wiring().torque_nm().abs());
        assert!(
            bench.board.time_s() - from_s < PATIENCE_S,
            "still on, up to {largest_nm} N m"
        );
    }
    (bench.board.time_s() - from_s, largest_nm)
}

#[test]
fn a_current_sensor_stuck_at_mid_range_trips_before_the_motor_is_damaged() {
    /// Longest time from the start of the integrator windup.
    const LONGEST_S: f64 = 0.008;
    let Some(image) = image("a_current_sensor_stuck_in_the_middle") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("disarm");
    bench.command("arm torque");
    bench.command("ref 0.005");
    bench.run(0.001);
    bench.board.wiring_mut().amplifier.stuck_counts = Some(2048.0);
    let (took_s, largest_nm) = until_off(&mut bench);
    println!(
        "off after {:.2} ms, at most {:.1} mN m, {:.2} A",
        1e3 * took_s,
        1e3 * largest_nm,
        largest_nm / TORQUE_CONSTANT
    );
    assert!(took_s < LONGEST_S, "{took_s}");
    assert!(largest_nm / TORQUE_CONSTANT < 1.6, "{largest_nm}");
    let said = bench.wait_for("> ");
    assert!(said.contains("does not follow"), "{said}");
}

#[test]
fn a_broken_motor_wire_trips() {
    const LONGEST_S: f64 = 0.015;
    let Some(image) = image("a_motor_wire_that_breaks") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("disarm");
    bench.command("arm torque");
    bench.command("ref 0.003");
    bench.board.wires_mut().motor_cut = true;
    let (took_s, _) = until_off(&mut bench);
    println!("off after {:.2} ms", 1e3 * took_s);
    assert!(took_s < LONGEST_S, "{took_s}");
    let said = bench.wait_for("> ");
    assert!(said.contains("motor wire"), "{said}");
}

#[test]
fn the_resistance_is_measured_and_fast_motion_with_a_hot_winding_is_no_mismatch() {
    let Some(image) = image("fast_motion_and_a_hot_winding") else {
        return;
    };
    let mut device = setup(presets::refit());
    // The true resistance is 50 % above the data sheet, as in the lab's own firmware.
    if let host_sim::paddle::Actuator::Bridge(motor) = &mut device.paddle.actuator {
        motor.resistance_ohm = 15.6;
        motor.supply_v = 22.0;
    }
    let mut bench = Bench::with(image, &device, Wires::default());
    bench.boot();
    bench.command("zero hall");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
    // The measurement uses the voltage of the push. The firmware assumes a supply of 24 V, so it finds 15.6 times 24 over
    // 22.
    let resistance = bench.command("get motor.resistance");
    let ohm = resistance.split("= ").nth(1).unwrap();
    let ohm: f64 = ohm.split(' ').next().unwrap().parse().unwrap();
    assert!((ohm - 17.0).abs() < 1.0, "{resistance}");
    bench.command("ref 0");
    bench.command("start square 25 4");
    bench.run(1.5);
    let status = bench.command("status");
    assert!(!status.contains("fault"), "{status}");
}

#[test]
fn the_converter_samples_the_signals_without_a_settling_error() {
    let Some(image) = image("the_converter_sees_the_signals") else {
        return;
    };
    let mut device = crate::bench::quiet(held());
    device.paddle.start_rad = 0.5;
    let mut bench = Bench::with(image, &device, Wires::default());
    bench.boot();
    bench.board.record_steps(true);
    bench.run(0.01);
    let step = *bench.board.take_steps().last().unwrap();
    let current = f64::from(step.current.sum) / f64::from(step.current.conversions);
    println!("{current} counts at rest");
    assert!((current - 2048.0).abs() < 0.25, "{current}");
    let status = bench.command("status");
    let hall = status.split("hall ").nth(1).unwrap();
    let hall_deg: f64 = hall.split(' ').next().unwrap().parse().unwrap();
    // One count is 0.037°.
    assert!((hall_deg - 0.5_f64.to_degrees()).abs() < 0.03, "{status}");
}

#[test]
fn after_a_halt_the_samples_are_synchronous_with_the_control_periods_again() {
    /// Time for the ring buffer to restart and to fill, with a margin.
    const RECOVERY_S: f64 = 1e-3;
    /// Not a multiple of a sample (2 µs) or of a control period (50 µs), so that the halts begin and end at many phases of
    /// both.
    const BETWEEN_HALTS_S: f64 = 1.013_7e-3;
    const LONGER_BY_S: f64 = 1.913e-6;

    let Some(image) = image("after_a_halt_the_samples_are_in_step") else {
        return;
    };
    let mut bench = Bench::armed(image);
    for halt in 0..100 {
        bench.run(BETWEEN_HALTS_S);
        let lasts_s = 1e-3 + LONGER_BY_S * f64::from(halt);
        bench.board.halt_core(lasts_s).unwrap();
        bench.run(RECOVERY_S);
        bench.board.record_steps(true);
        bench.run(1e-3);
        for step in bench.board.take_steps() {
            assert_eq!(
                (step.ring_left, step.current.conversions),
                (25, 25),
                "halt {halt} of {lasts_s} s: the ring holds one control period, and begins with it"
            );
        }
    }
}

#[test]
fn an_overrun_is_named_and_clear_brings_the_samples_back() {
    let Some(image) = image("an_overrun_is_named") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("ref 0");
    bench.board.overrun_current();
    bench.run(1.2e-3);
    assert_eq!(bench.board.bridge(), Bridge::Off);
    let said = bench.wait_for("> ");
    assert!(
        said.contains("converter") && said.contains("clear"),
        "{said}"
    );
    bench.command("clear");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
    bench.command("ref 10");
    bench.run(0.5);
    let status = bench.command("status");
    assert!(!status.contains("fault"), "{status}");
}
