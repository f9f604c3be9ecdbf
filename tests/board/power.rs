//! Tests of power-on, of the crystal, and of supply dips.

use crate::bench::{Bench, image, setup};
use host_sim::presets;
use virtual_board::board::Bridge;
use virtual_board::cpu::Memories;
use virtual_board::peripherals::rcc::ResetCause;
use virtual_board::wiring::Wires;

#[test]
fn the_enables_are_low_within_microseconds_of_the_reset() {
    /// A few dozen instructions at 16 MHz.
    const SOON_S: f64 = 10e-6;
    let Some(image) = image("the_enables_are_low_within_microseconds") else {
        return;
    };
    let mut bench = Bench::new(image);
    assert_eq!(bench.board.bridge(), Bridge::EnablesFloat);
    while bench.board.bridge() == Bridge::EnablesFloat {
        bench.run(1e-6);
        assert!(bench.board.time_s() < SOON_S, "the enables still float");
    }
    println!(
        "enables low {:.1} µs after the reset",
        1e6 * bench.board.time_s()
    );
    bench.board.record_steps(true);
    bench.boot();
    assert_eq!(bench.board.bridge(), Bridge::Off);
    assert!(
        bench
            .board
            .take_steps()
            .iter()
            .all(|step| step.duty.is_none())
    );
}

#[test]
fn a_crystal_that_never_starts_is_reported_and_prevents_arming() {
    let Some(image) = image("a_crystal_that_never_starts") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.board.set_crystal(false);
    let greeting = bench.boot();
    assert!(greeting.contains("crystal"), "{greeting}");
    bench.command("zero hall");
    for line in ["arm", "arm torque"] {
        let refusal = bench.command(line);
        assert!(refusal.contains("crystal"), "{refusal}");
    }
    assert_eq!(bench.board.bridge(), Bridge::Off);
    // The watchdog runs all the same.
    bench.board.memories().flash_mut().fill(0xBF);
    while bench.board.resets().is_empty() {
        bench.run(1e-3);
        assert!(bench.board.time_s() < 3.0, "no watchdog");
    }
}

#[test]
fn a_dip_of_the_supply_turns_the_outputs_off() {
    let Some(mut bench) = Bench::pushing("a_dip_of_the_supply") else {
        return;
    };
    bench.board.set_supply(2.9);
    bench.run(2e-6);
    assert_eq!(bench.board.bridge(), Bridge::Off, "2 µs after the dip");
    // The supply falls below the operating range of the core and returns.
    bench.board.set_supply(2.85);
    bench.run(0.01);
    bench.board.set_supply(3.3);
    let said = bench.wait_for("> ");
    assert!(
        said.contains("fault: ") && said.contains("supply"),
        "{said}"
    );
    bench.command("clear");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
}

#[test]
fn a_low_supply_prevents_arming() {
    let Some(mut bench) = Bench::pushing("while_the_supply_is_low") else {
        return;
    };
    bench.board.set_supply(2.9);
    bench.wait_for("> ");
    bench.command("clear");
    bench.run(0.01);
    let refusal = bench.command("arm");
    assert!(refusal.contains("supply"), "{refusal}");
    assert_eq!(bench.board.bridge(), Bridge::Off);
}

#[test]
fn the_brown_out_level_is_set_at_the_first_boot_and_holds_the_chip_in_reset() {
    let Some(image) = image("the_brown_out_level") else {
        return;
    };
    let mut bench = Bench::fresh(image, &setup(presets::refit()), Wires::default());
    bench.boot();
    println!("booted after {:.3} s", bench.board.time_s());
    // The option bytes take effect at the next power-on.
    bench.board.interrupt_supply(0.05);
    bench.boot();
    bench.command("zero hall");
    bench.command("arm");
    bench.command("ref 20");
    assert!(bench.drives());
    bench.board.set_supply(2.6);
    assert_eq!(bench.board.resets().last().unwrap().1, ResetCause::BrownOut);
    bench.run(0.05);
    assert_ne!(bench.board.bridge(), Bridge::Driven(0.0));
    assert!(!bench.drives());
    bench.board.set_supply(3.3);
    let greeting = bench.boot();
    assert!(greeting.contains("disarmed"), "{greeting}");
}

#[test]
fn a_crystal_that_stops_brakes_the_motor_without_firmware() {
    let Some(mut bench) = Bench::pushing("a_crystal_that_stops_breaks_the_outputs") else {
        return;
    };
    // The exception handler is replaced by an endless loop.
    const BRANCH_TO_ITSELF: [u8; 2] = 0xE7FEu16.to_le_bytes();
    let handler = bench.address_of(&["DefaultHandler"]);
    let at = (handler - Memories::FLASH) as usize;
    bench.board.memories().flash_mut()[at..at + 2].copy_from_slice(&BRANCH_TO_ITSELF);
    bench.board.set_crystal(false);
    assert_eq!(bench.board.bridge(), Bridge::Driven(0.0), "brakes at once");
    bench.run(0.005);
    assert_eq!(bench.board.bridge(), Bridge::Driven(0.0), "still brakes");
}
