//! Time: SysTick, sleep, the cycle counter, flash.

use super::*;
use crate::cpu::FlashTiming;

#[test]
fn systick_comes_every_reload_and_one_cycles() {
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
fn sleep_ends_exactly_where_the_board_wakes_it() {
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
fn an_event_lets_one_wait_pass() {
    // SEV; WFE; MOVS R0, #1; WFE; MOVS R0, #2
    let mut bench = Bench::new(&[0xBF40, 0xBF20, 0x2001, 0xBF20, 0x2002]);
    bench.go(100);
    assert_eq!(bench.r(0), 1);
    assert!(bench.cpu.asleep());
}

#[test]
fn the_cycle_counter_counts_what_is_not_slept() {
    let mut bench = Bench::new(&[NOP, NOP, NOP, WAIT_FOR_INTERRUPT]);
    bench.poke(0xE000_1004, 100);
    bench.poke(0xE000_1000, 1);
    bench.go(1_000);
    assert_eq!(bench.peek(0xE000_1004), 104);
}

#[test]
fn a_run_ends_at_its_cycle_whatever_it_was_asked_before() {
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
fn flash_waits_where_nothing_has_been_read_ahead() {
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
    // Eight instructions a line hide the six cycles of reading the next.
    assert_eq!(cycles(ahead)[0], 64 + 5);
    let cached = FlashTiming {
        instruction_cache: true,
        ..slow
    };
    assert_eq!(cycles(cached), [64 + 8 * 5, 64]);
}
