//! Tests with a debugger that halts and resumes the core.

use crate::bench::Bench;
use virtual_board::board::{Bridge, Pause};

/// Two control periods.
const TWO_PERIODS_S: f64 = 1e-4;

#[test]
fn no_input_of_the_bridge_floats_during_a_halt() {
    let Some(mut bench) = Bench::pushing("a_halt_leaves_no_input_of_the_bridge_to_float") else {
        return;
    };
    bench.board.begin_halt();
    let at_halt = bench.board.bridge();
    bench.board.stand_still(0.1).unwrap();
    let later = bench.board.bridge();
    for bridge in [at_halt, later] {
        assert!(
            matches!(bridge, Bridge::Off | Bridge::Driven(0.0)),
            "halted, the chip tells the bridge {bridge:?}"
        );
    }
    bench.board.end_halt();
}

#[test]
fn after_a_halt_the_bridge_is_off_until_the_fault_is_cleared() {
    let Some(mut bench) = Bench::pushing("after_a_halt_the_bridge_is_off") else {
        return;
    };
    bench.board.halt_core(0.1).unwrap();
    assert!(
        bench.board.resets().is_empty(),
        "the watchdog stood still too"
    );
    bench.run(TWO_PERIODS_S);
    assert_eq!(bench.board.bridge(), Bridge::Off);
    let said = bench.wait_for("> ");
    assert!(
        said.contains("fault: ") && said.contains("debugger"),
        "{said}"
    );
    let refusal = bench.command("arm");
    assert!(refusal.contains("debugger"), "{refusal}");
    bench.command("clear");
    let armed = bench.command("arm");
    assert!(armed.contains("mode position"), "{armed}");
}

/// The runner that `cargo run` starts with the image.
fn runner() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/.cargo/config.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let line = text.lines().find(|line| line.starts_with("runner"));
    line.unwrap_or_else(|| panic!("no runner in {path}")).into()
}

#[test]
fn the_flash_command_lets_a_fault_reach_its_handler() {
    let Some(mut bench) = Bench::pushing("the_flash_command_lets_a_fault_reach_its_handler") else {
        return;
    };
    // By default probe-rs halts the core at a hard fault before the first instruction of the handler.
    let catches = !runner().contains("--no-catch-hardfault");
    let handler = bench.address_of(&["HardFault"]);
    bench.board.cpu.set_breakpoint(handler, catches);
    while bench.board.cpu.exception() != 0 || bench.board.cpu.asleep() {
        bench.run(1e-7);
    }
    bench.board.cpu.set_register(15, 0x3000_0000);
    let end_s = bench.board.time_s() + 5e-6;
    while let Pause::Breakpoint(_) = bench.board.run_until(end_s).unwrap() {
        bench.board.begin_halt();
        bench.board.stand_still(0.1).unwrap();
        assert_eq!(bench.board.bridge(), Bridge::Off, "halted at the fault");
        bench.board.end_halt();
    }
    assert_eq!(bench.board.bridge(), Bridge::Off);
}
