//! Tests that every failure turns the bridge off.
//!
//! The image has no code for these tests. They change the state of the core from outside, as a radiation event would.

use crate::bench::{Bench, image};
use virtual_board::cpu::{Memories, Width};
use virtual_board::peripherals::rcc::ResetCause;

/// Longest time from a failure to disabled outputs, s: a few dozen instructions.
const AT_ONCE_S: f64 = 5e-6;
/// RAM between variables and stack, which the firmware does not use.
const UNUSED_RAM: u32 = 0x2001_0000;

/// An armed bench in the middle of a step, with the core awake in thread mode.
fn driving(test: &str) -> Option<Bench> {
    let mut bench = Bench::armed(image(test)?);
    bench.board.type_in("step 10\r");
    bench.run(0.005);
    while bench.board.cpu.exception() != 0 || bench.board.cpu.asleep() {
        bench.run(1e-7);
    }
    assert!(bench.drives());
    Some(bench)
}

/// Checks that the outputs go off at once and stay off, that the watchdog resets the core, and that the console then reports
/// the reason.
fn ends_in_a_reset(bench: &mut Bench, reason: &str) {
    let struck_s = bench.board.time_s();
    bench.run(AT_ONCE_S);
    assert!(!bench.drives(), "the bridge still drives");
    while bench.board.resets().is_empty() {
        bench.run(1e-3);
        assert!(!bench.drives(), "the bridge drives again");
        assert!(bench.board.time_s() - struck_s < 0.04, "no reset");
    }
    assert_eq!(bench.board.resets()[0].1, ResetCause::IndependentWatchdog);
    bench.board.terminal.take_answer();
    let greeting = bench.boot();
    assert!(greeting.contains(reason), "{greeting}");
    assert!(greeting.contains("disarmed"), "{greeting}");
    assert!(!bench.drives());
}

#[test]
fn a_hung_console_is_reset_with_the_outputs_off() {
    let Some(mut bench) = driving("a_hung_console_is_reset") else {
        return;
    };
    // The next instruction of the console loop is replaced by a branch to itself.
    const BRANCH_TO_ITSELF: [u8; 2] = 0xE7FEu16.to_le_bytes();
    let pc = bench.board.cpu.register(15);
    let at = (pc - Memories::FLASH) as usize;
    let sound: [u8; 2] = bench.board.memories().flash()[at..at + 2]
        .try_into()
        .unwrap();
    bench.board.memories().flash_mut()[at..at + 2].copy_from_slice(&BRANCH_TO_ITSELF);
    let struck_s = bench.board.time_s();
    while bench.board.resets().is_empty() {
        bench.run(1e-3);
        assert!(bench.board.time_s() - struck_s < 0.04, "no reset");
    }
    let (reset_s, cause) = bench.board.resets()[0];
    assert_eq!(cause, ResetCause::IndependentWatchdog);
    println!("reset {:.1} ms after the hang", 1e3 * (reset_s - struck_s));
    assert!(!bench.drives());
    bench.board.memories().flash_mut()[at..at + 2].copy_from_slice(&sound);
    bench.board.terminal.take_answer();
    let greeting = bench.boot();
    assert!(greeting.contains("reset by the watchdog"), "{greeting}");
}

#[test]
fn a_panic_turns_the_outputs_off() {
    let Some(mut bench) = driving("a_panic_turns_the_outputs_off") else {
        return;
    };
    let divide_by_zero = bench.address_of(&["panic_const_div_by_zero"]);
    // Location of the panic as the compiler passes it: file, line and column.
    const FILE: &[u8; 5] = b"x.rs\0";
    let location = [UNUSED_RAM + 16, 4, 12, 34];
    for (place, word) in (0..).zip(location) {
        let written = bench
            .board
            .memories()
            .write(UNUSED_RAM + 4 * place, Width::Word, word);
        assert!(written.is_some());
    }
    for (place, byte) in (0..).zip(FILE) {
        let written =
            bench
                .board
                .memories()
                .write(UNUSED_RAM + 16 + place, Width::Byte, u32::from(*byte));
        assert!(written.is_some());
    }
    bench.board.cpu.set_register(0, UNUSED_RAM);
    bench.board.cpu.set_register(15, divide_by_zero);
    ends_in_a_reset(&mut bench, "before the reset: panicked at x.rs:12:34");
}

#[test]
fn a_jump_to_nowhere_turns_the_outputs_off() {
    let Some(mut bench) = driving("a_jump_to_nowhere") else {
        return;
    };
    bench.board.cpu.set_register(15, 0x3000_0000);
    ends_in_a_reset(&mut bench, "before the reset: exception 3 at 0x30000000");
}

#[test]
fn a_lost_stack_turns_the_outputs_off() {
    let Some(mut bench) = driving("a_lost_stack") else {
        return;
    };
    // The stack pointer is invalid, so the next interrupt cannot push its registers.
    bench.board.cpu.set_register(13, 0x1800_0000);
    bench.run(60e-6);
    ends_in_a_reset(&mut bench, "before the reset: exception 3");
}

#[test]
fn a_crystal_that_stops_turns_the_outputs_off() {
    let Some(mut bench) = driving("a_crystal_that_stops") else {
        return;
    };
    bench.board.set_crystal(false);
    bench.run(2e-5);
    assert!(!bench.drives());
    // Without the crystal the board does not boot, but the bridge stays off.
    bench.run(0.2);
    assert!(!bench.drives());
    assert!(!bench.board.resets().is_empty());
}

#[test]
fn a_fault_of_the_bridge_turns_the_outputs_off_and_is_latched() {
    let Some(mut bench) = driving("a_fault_of_the_bridge") else {
        return;
    };
    bench.board.set_bridge_fault(true);
    bench.run(1e-6);
    assert!(!bench.drives());
    bench.run(0.01);
    bench.board.set_bridge_fault(false);
    bench.wait_for("ready\r\n> ");
    bench.run(0.01);
    assert!(!bench.drives());
    assert!(bench.command("status").contains("fault"));
    let refusal = bench.command("arm");
    assert!(refusal.contains("fault"), "{refusal}");
    bench.command("clear");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
    assert!(bench.drives());
}
