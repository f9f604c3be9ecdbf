//! Tests of nFAULT, of the inputs of the bridge, and of its 24 V supply.

use crate::bench::{Bench, CONTROL, image};
use virtual_board::board::Bridge;

/// Exception number of EXTI lines 10 to 15.
const FAULT_LINE: u16 = 16 + 40;

#[test]
fn a_glitch_of_nfault_turns_the_outputs_off_for_at_most_a_control_period() {
    let Some(mut bench) = Bench::pushing("a_glitch_of_nfault") else {
        return;
    };
    bench.board.set_bridge_fault(true);
    bench.run(0.5e-6);
    assert_eq!(bench.board.bridge(), Bridge::Off, "off at once");
    bench.board.set_bridge_fault(false);
    bench.run(1e-4);
    assert!(bench.drives(), "on again with the next period");
    let faults = bench.command("faults");
    assert!(faults.contains("no fault"), "{faults}");
    assert!(faults.contains("nFAULT glitch 1"), "{faults}");
}

#[test]
fn nfault_that_stays_low_is_latched_with_one_interrupt() {
    let Some(mut bench) = Bench::pushing("nfault_that_stays_low") else {
        return;
    };
    let before = bench.board.cpu.totals(FAULT_LINE).count;
    bench.board.set_bridge_fault(true);
    bench.run(4e-6);
    bench.board.set_bridge_fault(false);
    bench.run(1e-4);
    assert_eq!(bench.board.bridge(), Bridge::Off);
    // If the handler returned before its write took effect, it would run twice.
    assert_eq!(bench.board.cpu.totals(FAULT_LINE).count - before, 1);
    let said = bench.wait_for("> ");
    assert!(said.contains("fault: H-bridge"), "{said}");
}

#[test]
fn a_bridge_without_24_v_at_boot_is_reported_but_not_latched() {
    let Some(image) = image("without_its_24_v_at_boot") else {
        return;
    };
    let mut bench = Bench::new(image);
    bench.board.set_bridge_fault(true);
    bench.run(0.5);
    let said = bench.wait_for("> ");
    assert!(said.contains("24 V"), "{said}");
    bench.command("zero hall");
    let refusal = bench.command("arm");
    assert!(refusal.contains("24 V"), "{refusal}");
    bench.board.set_bridge_fault(false);
    bench.wait_for("ready\r\n> ");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
}

#[test]
fn the_bootstrap_is_charged_at_the_largest_duty() {
    /// Charging time per period at 30 kHz with the lab's duty limit of 0.98.
    const CHARGED_S: f64 = 333e-9;
    let Some(image) = image("the_bootstrap_is_charged") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("ref 0");
    // The stated supply is a quarter of the true supply, so the regulator requests the full duty.
    bench.board.type_in("set motor.supply 6\rref 30\r");
    bench.run(0.02);
    let low_s = bench.board.shortest_low_s();
    println!("low for {:.0} ns at least", 1e9 * low_s);
    assert!(low_s < 2e-6, "never near the largest duty: {low_s}");
    assert!(low_s > CHARGED_S, "{low_s}");
    assert!(bench.board.cpu.totals(CONTROL).count > 0);
}
