//! Tests of the safety functions.

use crate::bench::{Bench, image, setup};
use host_sim::device::Device;
use host_sim::plant::Barrier;
use host_sim::presets;
use virtual_board::board::Bridge;
use virtual_board::wiring::Wires;

/// The refitted paddle with an end stop at 0.2 rad.
fn stopped() -> Device {
    let mut device = presets::refit();
    device.mechanics.barriers[0] = Some(Barrier {
        at: 0.2,
        side: 1.0,
        stiffness: 30.0,
        damping: 0.1,
        torque_nm: 0.0,
        during_s: None,
    });
    device
}

/// A bench in torque mode.
fn in_torque_mode(test: &str) -> Option<Bench> {
    let mut bench = Bench::armed(image(test)?);
    bench.command("disarm");
    bench.command("arm torque");
    Some(bench)
}

/// Runs until the bridge is off and returns the time in s.
fn until_off(bench: &mut Bench, patience_s: f64) -> f64 {
    let from_s = bench.board.time_s();
    while bench.drives() {
        bench.run(50e-6);
        let waited_s = bench.board.time_s() - from_s;
        assert!(waited_s < patience_s, "still on after {waited_s} s");
    }
    bench.board.time_s() - from_s
}

#[test]
fn the_board_disarms_when_a_program_stops_sending() {
    let Some(mut bench) = Bench::pushing("a_program_that_has_spoken") else {
        return;
    };
    // Without a program the terminal may be silent.
    bench.run(0.5);
    assert!(bench.drives());
    let answer = bench.command("beat");
    assert!(answer.contains("beat"), "{answer}");
    for _ in 0..5 {
        bench.run(0.15);
        assert!(bench.drives());
        bench.command("beat");
    }
    let took_s = until_off(&mut bench, 0.3);
    println!("off {:.0} ms after the last beat", 1e3 * took_s);
    assert!((0.19..0.21).contains(&took_s), "{took_s}");
    let said = bench.wait_for("> ");
    assert!(said.contains("gone silent"), "{said}");
    bench.command("clear");
    bench.command("beat off");
    bench.command("arm");
    bench.run(0.5);
    assert!(bench.drives(), "a person may be silent again");
    bench.command("disarm");
    bench.command("beat");
    bench.command("set host.heartbeat 0");
    bench.command("arm");
    bench.run(0.5);
    assert!(bench.drives(), "0 is off");
}

#[test]
fn ctrl_c_stops_in_every_state() {
    /// Time for one byte on the line and for the check after the next control period.
    const SOON_S: f64 = 85e-6;
    let Some(image) = image("ctrl_c_stops_in_every_state") else {
        return;
    };
    for state in [
        "position",
        "torque",
        "settling",
        "checking",
        "half a line",
        "flood",
    ] {
        let mut bench = Bench::new(image.clone());
        bench.boot();
        bench.command("zero hall");
        match state {
            "settling" => {
                bench.board.type_in("arm\r");
                bench.run(0.03);
            }
            "checking" => {
                bench.board.type_in("arm\r");
                bench.run(0.09);
            }
            "torque" => {
                bench.command("arm torque");
                bench.command("ref 0.002");
            }
            _ => {
                bench.command("arm");
                bench.command("ref 5");
            }
        }
        match state {
            "half a line" => bench.board.type_in("set kp 0.0"),
            "flood" => {
                bench.board.type_in(&"get\r".repeat(400));
                bench.run(0.04);
            }
            _ => {}
        }
        bench.run(0.001);
        assert!(bench.board.bridge() != Bridge::Off, "{state}: not on");
        bench.board.type_in("\x03");
        bench.run(SOON_S);
        assert_eq!(bench.board.bridge(), Bridge::Off, "{state}");
        bench.run(0.5);
        assert_eq!(bench.board.bridge(), Bridge::Off, "{state}, later");
        let said = bench.board.terminal.take_answer();
        let said = String::from_utf8_lossy(&said);
        assert!(said.contains("stopped by Ctrl-C"), "{state}: {said}");
    }
}

#[test]
fn the_button_stops_in_every_state() {
    let Some(image) = image("the_button_stops_in_every_state") else {
        return;
    };
    for wait_s in [0.03, 0.09, 0.5] {
        let mut bench = Bench::new(image.clone());
        bench.boot();
        bench.command("zero hall");
        bench.board.type_in("arm\r");
        bench.run(wait_s);
        assert!(bench.board.bridge() != Bridge::Off, "{wait_s}: not on");
        bench.board.set_button(true);
        bench.run(20e-6);
        assert_eq!(bench.board.bridge(), Bridge::Off, "{wait_s}");
        bench.board.set_button(false);
        bench.run(0.5);
        assert_eq!(bench.board.bridge(), Bridge::Off, "{wait_s}, later");
        let said = bench.board.terminal.take_answer();
        let said = String::from_utf8_lossy(&said);
        assert!(said.contains("stopped by the button"), "{wait_s}: {said}");
        let armed = bench.command("arm");
        assert!(armed.contains("mode position"), "{armed}");
    }
}

#[test]
fn torque_mode_requires_the_wiring_check_too() {
    let Some(image) = image("torque_mode_asks_for_the_wiring_check") else {
        return;
    };
    let mut wires = Wires::default();
    assert!(wires.change("encoder-swapped"));
    let mut bench = Bench::with(image, &setup(presets::refit()), wires);
    bench.boot();
    let refusal = bench.command("arm torque");
    assert!(refusal.contains("swap its wires A and B"), "{refusal}");
    assert_eq!(bench.board.bridge(), Bridge::Off);
}

#[test]
fn limits_cannot_be_set_beyond_the_hardware_ratings() {
    let Some(image) = image("limits_cannot_be_set_beyond") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    for line in [
        "set limit.current 1.6",
        "set limit.speed 3000",
        "set limit.travel 90",
        "set limit.disagreement 30",
        "set motor.torque_limit 0.05",
    ] {
        let refusal = bench.command(line);
        assert!(refusal.contains("must be a number from"), "{refusal}");
    }
}

#[test]
fn a_motor_overload_trips() {
    let Some(image) = image("a_motor_that_carries_too_much") else {
        return;
    };
    let mut bench = Bench::with(image, &setup(stopped()), Wires::default());
    bench.boot();
    bench.command("zero hall");
    bench.command("arm torque");
    // The stated torque constant is too small, so the regulator requests more current than the motor tolerates.
    bench.command("set limit.stall 0");
    bench.command("set limit.disagreement 20");
    bench.command("set motor.torque_constant 0.034");
    bench.command("ref 0.032");
    let took_s = until_off(&mut bench, 12.0);
    bench.run(0.05);
    let said = bench.wait_for("> ");
    println!("{took_s:.2} s: {said}");
    assert!(said.contains("carried too much current"), "{said}");
}

#[test]
fn a_loss_of_the_encoder_under_torque_trips_in_time() {
    /// Limits from the loss of the encoder at full torque: time and angle.
    const LONGEST_S: f64 = 0.016;
    const FARTHEST_DEG: f64 = 6.0;
    let Some(mut bench) = in_torque_mode("an_encoder_that_is_lost_under_torque") else {
        return;
    };
    bench.board.type_in("ref 0.032\r");
    while bench.board.wiring().torque_nm() < 0.02 {
        bench.run(50e-6);
    }
    bench.board.wires_mut().encoder_cut = true;
    let from_deg = bench.board.wiring().paddle().position_rad().to_degrees();
    let took_s = until_off(&mut bench, 0.1);
    let moved_deg = bench.board.wiring().paddle().position_rad().to_degrees() - from_deg;
    bench.run(0.05);
    println!("off {:.1} ms and {moved_deg:.1}° later", 1e3 * took_s);
    assert!(took_s < LONGEST_S, "{took_s}");
    assert!(moved_deg.abs() < FARTHEST_DEG, "{moved_deg}");
    let said = bench.wait_for("> ");
    assert!(said.contains("encoder"), "{said}");
}

#[test]
fn a_stall_at_a_stop_trips() {
    let Some(image) = image("a_stall_at_a_stop") else {
        return;
    };
    let mut bench = Bench::with(image, &setup(stopped()), Wires::default());
    bench.boot();
    bench.command("zero hall");
    bench.command("arm");
    bench.command("ref 35");
    let took_s = until_off(&mut bench, 2.0);
    println!("off after {took_s:.2} s");
    assert!((0.9..1.3).contains(&took_s), "{took_s}");
    let said = bench.wait_for("> ");
    assert!(said.contains("nothing moves"), "{said}");
}

#[test]
fn every_missed_control_tick_is_counted() {
    let Some(mut bench) = Bench::pushing("no_missed_control_tick") else {
        return;
    };
    let ticks = bench.address_of(&["firmware", "5TICKS"]);
    let read = |bench: &mut Bench| {
        let word = bench
            .board
            .memories()
            .read(ticks, virtual_board::cpu::Width::Word);
        word.unwrap()
    };
    bench.run(50e-6);
    let before = (bench.board.time_s(), read(&mut bench));
    // The core executes nothing for 7.5 control periods while all clocks run.
    bench.board.stand_still(375e-6).unwrap();
    bench.run(1e-3);
    let after = (bench.board.time_s(), read(&mut bench));
    let periods = ((after.0 - before.0) / 50e-6).round() as u32;
    assert!(
        (after.1 - before.1).abs_diff(periods) <= 1,
        "{} ticks in {periods} periods",
        after.1 - before.1
    );
    let said = bench.wait_for("> ");
    assert!(said.contains("came late"), "{said}");
}

#[test]
fn faults_and_their_values_survive_a_reset_in_order() {
    let Some(mut bench) = Bench::pushing("faults_are_kept") else {
        return;
    };
    bench.board.set_supply(2.9);
    bench.run(1e-4);
    bench.board.set_bridge_fault(true);
    bench.run(1e-3);
    bench.board.overrun_current();
    bench.run(1e-3);
    bench.board.set_supply(3.3);
    bench.board.set_bridge_fault(false);
    bench.run(0.2);
    bench.board.terminal.take_answer();
    let faults = bench.command("faults");
    let supply = faults.find("3.3 V supply").unwrap();
    let converter = faults.find("converter").unwrap();
    assert!(supply < converter, "{faults}");
    assert!(
        faults.contains("torque") && faults.contains("limits acted"),
        "{faults}"
    );

    bench.board.press_reset();
    let greeting = bench.boot();
    assert!(greeting.contains("reset pin"), "{greeting}");
    let faults = bench.command("faults");
    let supply = faults.find("3.3 V supply").unwrap();
    let converter = faults.find("converter").unwrap();
    assert!(supply < converter, "{faults}");
    assert!(faults.contains("before the reset"), "{faults}");
    assert!(faults.contains("reset pin"), "{faults}");
}
