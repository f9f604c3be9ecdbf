//! Tests of the console over the serial port.

use crate::bench::{Bench, image, setup};
use host_sim::presets;
use virtual_board::wiring::Wires;

#[test]
fn the_console_answers_commands() {
    let Some(image) = image("console") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    let help = bench.command("help");
    for name in ["zero", "arm", "step", "status"] {
        assert!(help.contains(name), "{help}");
    }
    assert!(
        bench
            .command("set kp 0.06")
            .contains("pid.kp = 0.06 N m/deg")
    );
    assert!(bench.command("get kp").contains("pid.kp = 0.06 N m/deg"));
    assert!(
        bench
            .command("get kq\x7fp")
            .contains("pid.kp = 0.06 N m/deg")
    );
    assert!(bench.command("fly").contains("no such command"));
    assert!(bench.command("set kp high").contains("pid.kp"));
}

#[test]
fn the_output_of_dump_can_be_typed_as_input() {
    let Some(image) = image("a_dump_can_be_pasted_back") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    bench.command("set kp 0.06");
    let dump = bench.command("dump");
    assert!(
        dump.contains("set pid.kp 0.06 # N m/deg at the paddle"),
        "{dump}"
    );
    let lines: String = dump
        .lines()
        .filter(|line| line.starts_with("set "))
        .map(|line| format!("{line}\r"))
        .collect();
    bench.command("set kp 0.01");
    bench.board.type_in(&lines);
    bench.run(0.5);
    let said = bench.wait_for("\n> ");
    assert!(
        said.contains("metrics.band = 0.2 deg") && !said.contains("lost"),
        "{said}"
    );
    assert_eq!(bench.command("dump"), dump);
}

#[test]
fn an_input_overrun_is_reported_and_has_no_other_effect() {
    let Some(image) = image("a_flood_of_input_is_reported") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.board.type_in(&"get\r".repeat(1000));
    bench.run(1.0);
    let said = bench.wait_for("> ");
    assert!(said.contains("input lost: send slower"), "{said}");
    assert!(said.contains("pid.kp"), "{said}");
    assert!(bench.command("status").contains("mode position"));
}

#[test]
fn arming_requires_a_zero() {
    let Some(image) = image("arming_wants_a_zero") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    let refusal = bench.command("arm");
    assert!(refusal.contains("zero"), "{refusal}");
    assert!(bench.command("status").contains("mode off"));
    assert!(!bench.drives());
}

#[test]
fn arming_detects_and_names_a_wrong_wire() {
    let Some(image) = image("arming_finds_a_wrong_wire") else {
        return;
    };
    for (fault, named) in [
        ("motor-swapped", "motor"),
        ("motor-cut", "motor"),
        ("encoder-swapped", "encoder"),
        ("encoder-cut", "encoder"),
        ("hall-swapped", "Hall"),
    ] {
        let mut wires = Wires::default();
        assert!(wires.change(fault));
        let mut bench = Bench::with(image.clone(), &setup(presets::refit()), wires);
        bench.boot();
        bench.command("zero hall");
        let refusal = bench.command("arm");
        assert!(refusal.contains(named), "{fault}: {refusal}");
        assert!(bench.command("status").contains("mode off"), "{fault}");
        assert!(!bench.drives(), "{fault}");
    }
}

#[test]
fn a_disconnected_hall_sensor_gives_no_zero() {
    let Some(image) = image("a_hall_sensor_that_is_cut") else {
        return;
    };
    let mut wires = Wires::default();
    assert!(wires.change("hall-cut"));
    let mut bench = Bench::with(image, &setup(presets::refit()), wires);
    bench.boot();
    let refusal = bench.command("zero hall");
    assert!(refusal.contains("Hall signal"), "{refusal}");
    // After manual zeroing, the wiring check detects the cut wire.
    bench.command("zero");
    let refusal = bench.command("arm");
    assert!(refusal.contains("Hall"), "{refusal}");
    assert!(!bench.drives());
}

#[test]
fn version_timing_and_reboot_work() {
    let Some(image) = image("version_timing_and_reboot") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.boot();
    let version = bench.command("version");
    assert!(
        version.contains("commit ") && !version.contains("simulated"),
        "{version}"
    );
    bench.command("timing");
    bench.run(0.01);
    let timing = bench.command("timing");
    println!("{timing}");
    let worst = timing.split(" us at worst").next().unwrap_or_default();
    let worst_us: f64 = worst.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((1.0..7.0).contains(&worst_us), "{timing}");
    bench.board.type_in("reboot\r");
    let greeting = bench.wait_for("disarmed; help lists the commands\r\nthe settings are the defaults; save stores them\r\n> ");
    assert!(greeting.contains("reset by"), "{greeting}");
}
