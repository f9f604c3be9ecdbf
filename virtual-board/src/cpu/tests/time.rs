//! Tests of timing: SysTick, sleep, the cycle counter, and flash.

use super::*;
use crate::cpu::FlashTiming;

#[test]
fn systick_fires_every_reload_value_plus_one_cycles() {
    let mut bench = Bench::new(&[WAIT_FOR_INTERRUPT, 0xE7FD]);
    bench.cpu.record_activations(true);
    bench.poke(0xE000_E014, 999);
    bench.poke(0xE000_E018, 0);
    bench.poke(0xE000_E010, 7);
    bench.go(10_500);
    let pended: Vec<u64> = bench
        .cpu
        .take_activations()
        .iter()
        .map(|activation| activation.pended)
        .collect();
    assert_eq!(pended, (1..=10).map(|i| i * 1000).collect::<Vec<_>>());
    assert!(bench.cpu.slept() > 9_000);
}

#[test]
fn sleep_ends_exactly_at_the_cycle_of_the_wake_up() {
    let mut bench = Bench::new(&[WAIT_FOR_INTERRUPT, 0xE7FD]);
    bench.enable(0, 0);
    bench.cpu.record_activations(true);
    bench.go(5_000);
    assert_eq!(bench.cpu.signals.cycle(), 5_000);
    bench.cpu.signals.set_line(0, true);
    bench.cpu.signals.set_line(0, false);
    bench.go(100);
    let done = bench.cpu.take_activations();
    assert_eq!((done[0].pended, done[0].entered), (5_000, 5_012));
}

#[test]
fn an_event_ends_one_wait_for_event() {
    // SEV; WFE; MOVS R0, #1; WFE; MOVS R0, #2
    let mut bench = Bench::new(&[0xBF40, 0xBF20, 0x2001, 0xBF20, 0x2002]);
    bench.go(100);
    assert_eq!(bench.r(0), 1);
    assert!(bench.cpu.asleep());
}

#[test]
fn the_cycle_counter_stops_during_sleep() {
    let mut bench = Bench::new(&[NOP, NOP, NOP, WAIT_FOR_INTERRUPT]);
    bench.poke(0xE000_1004, 100);
    bench.poke(0xE000_1000, 1);
    bench.go(1_000);
    assert_eq!(bench.peek(0xE000_1004), 104);
}

#[test]
fn each_run_ends_at_its_own_deadline() {
    let mut bench = Bench::new(&[]);
    for length in [1, 7, 1000, 3] {
        let before = bench.cpu.signals.cycle();
        bench.go(length);
        let taken = bench.cpu.signals.cycle() - before;
        assert!(
            (length..length + 4).contains(&taken),
            "{taken} for {length}"
        );
    }
}

#[test]
fn a_fetch_waits_for_flash_that_was_not_prefetched() {
    let main = nops(64);
    let cycles = |timing: FlashTiming| {
        let mut bench = Bench::new(&main);
        bench.cpu.signals.set_flash_timing(timing);
        bench.cpu.set_breakpoint(MAIN + 128, true);
        let mut passes = Vec::new();
        for _ in 0..2 {
            let before = bench.cpu.signals.cycle();
            bench.cpu.set_register(15, MAIN);
            assert_eq!(bench.run(10_000), Stop::Breakpoint(MAIN + 128));
            passes.push(bench.cpu.signals.cycle() - before);
        }
        passes
    };
    let slow = FlashTiming {
        wait_states: 5,
        ..FlashTiming::default()
    };
    assert_eq!(cycles(FlashTiming::default()), [64, 64]);
    assert_eq!(cycles(slow), [64 + 8 * 5; 2]);
    let ahead = FlashTiming {
        prefetch: true,
        ..slow
    };
    // Eight instructions per line hide the six cycles of reading the next line.
    assert_eq!(cycles(ahead)[0], 64 + 5);
    let cached = FlashTiming {
        instruction_cache: true,
        ..slow
    };
    assert_eq!(cycles(cached), [64 + 8 * 5, 64]);
}

#[test]
fn an_instruction_waits_for_the_result_of_the_previous_one() {
    const RAM: u32 = 0x2000_0100;
    const ADD_R0_0: u16 = 0x3000;
    const LOAD_R1_AT_R0: u16 = 0x6801;
    const LOAD_R2_AT_R0: u16 = 0x6802;
    const LOAD_R3_AT_R2: u16 = 0x6813;
    const STORE_R1_AT_R0: u16 = 0x6001;
    const STORE_R1_AT_R0_R3: u16 = 0x50C1;
    const ADD_S0_S1_S2: [u16; 2] = [0xEE30, 0x0A81];
    const ADD_S3_S0_S0: [u16; 2] = [0xEE70, 0x1A00];
    const ADD_S0_S4_TIMES_S5: [u16; 2] = [0xEE02, 0x0A22];
    const ADD_S4_S0_TIMES_S5: [u16; 2] = [0xEE00, 0x2A22];
    const STORE_S0_AT_R0: [u16; 2] = [0xED80, 0x0A00];
    let cycles = |code: &[&[u16]]| {
        let code = code.concat();
        let end = MAIN + 2 * code.len() as u32;
        let mut bench = Bench::new(&code);
        bench.poke(RAM, RAM);
        bench.cpu.set_register(0, RAM);
        bench.cpu.set_breakpoint(end, true);
        let before = bench.cpu.signals.cycle();
        assert_eq!(bench.run(1_000), Stop::Breakpoint(end));
        bench.cpu.signals.cycle() - before
    };
    // Loads overlap unless the address of one is the result of the other. Nothing overlaps with a preceding store.
    assert_eq!(cycles(&[&[LOAD_R1_AT_R0]]), 2);
    assert_eq!(cycles(&[&[LOAD_R1_AT_R0, LOAD_R2_AT_R0]]), 2 + 1);
    assert_eq!(cycles(&[&[LOAD_R2_AT_R0, LOAD_R3_AT_R2]]), 2 + 2);
    assert_eq!(cycles(&[&[LOAD_R1_AT_R0, STORE_R1_AT_R0]]), 2 + 1);
    assert_eq!(cycles(&[&[STORE_R1_AT_R0, LOAD_R1_AT_R0]]), 1 + 2);
    assert_eq!(cycles(&[&[STORE_R1_AT_R0_R3, LOAD_R1_AT_R0]]), 2 + 2);
    // The base register was computed by the preceding instruction.
    assert_eq!(cycles(&[&[ADD_R0_0, LOAD_R1_AT_R0]]), 1 + 1 + 2);
    assert_eq!(cycles(&[&[ADD_R0_0, NOP, LOAD_R1_AT_R0]]), 1 + 1 + 2);
    assert_eq!(cycles(&[&[ADD_R0_0, STORE_R1_AT_R0]]), 1 + 1 + 1);
    // FPU results delay the next instruction, unless it uses them as the addend of a multiplication.
    assert_eq!(cycles(&[&ADD_S0_S1_S2, &ADD_S3_S0_S0]), 1 + 1 + 1);
    assert_eq!(cycles(&[&ADD_S0_S1_S2, &[NOP], &ADD_S3_S0_S0]), 1 + 1 + 1);
    assert_eq!(cycles(&[&ADD_S0_S1_S2, &ADD_S4_S0_TIMES_S5]), 1 + 1 + 3);
    assert_eq!(cycles(&[&ADD_S0_S1_S2, &ADD_S0_S4_TIMES_S5]), 1 + 3);
    assert_eq!(cycles(&[&ADD_S0_S1_S2, &STORE_S0_AT_R0]), 1 + 1 + 2);
}
