//! Tests of the control interrupt under full load: duration, start jitter, and missed periods.

use crate::bench::{Bench, CONTROL, image};
use crate::load::load;

/// Limits. Instruction counts are exact; cycle counts come from a model.
const MOST_INSTRUCTIONS: u64 = 700;
const MOST_CYCLES: u64 = 1_000;
/// Largest start jitter, cycles at 168 MHz: 1 µs.
const MOST_JITTER_CYCLES: u64 = 168;
const PERIOD_CYCLES: u64 = 8_400;

const SECONDS: u32 = 10;

#[test]
fn the_control_interrupt_stays_within_its_limits_and_misses_no_period() {
    let Some(image) = image("control_interrupt") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.speed_up();
    bench
        .board
        .type_in("stream setpoint,encoder,hall,velocity,torque,current 2000\r");
    bench.board.cpu.record_activations(true);
    bench.board.terminal.take_answer();
    let mut answered = 0;
    for second in 0..SECONDS {
        load(&mut bench, second);
        answered += bench.board.terminal.take_answer().len();
    }
    let mut runs: Vec<_> = bench.board.cpu.take_activations();
    runs.retain(|run| run.exception == CONTROL);

    assert!(
        answered > 110_000 * SECONDS as usize,
        "only {answered} bytes: not full load"
    );
    let between: Vec<_> = runs
        .windows(2)
        .map(|pair| pair[1].entered - pair[0].entered)
        .collect();
    let late = between
        .iter()
        .filter(|cycles| cycles.abs_diff(PERIOD_CYCLES) > MOST_JITTER_CYCLES)
        .count();
    assert_eq!(late, 0, "control periods that began late or never");
    let phases = runs.iter().map(|run| {
        (run.entered - runs[0].entered) as i64 - expected(run.entered - runs[0].entered)
    });
    let (first, last) = phases.fold((0, 0), |(low, high), phase| {
        (low.min(phase), high.max(phase))
    });
    let jitter_cycles = (last - first) as u64;

    let mut instructions: Vec<_> = runs.iter().map(|run| run.instructions).collect();
    let mut cycles: Vec<_> = runs.iter().map(|run| run.cycles).collect();
    instructions.sort_unstable();
    cycles.sort_unstable();
    let (median, worst) = (runs.len() / 2, runs.len() - 1);
    println!(
        "{} control interrupts: {} instructions median, {} worst; {} model cycles median, {} worst; jitter {:.3} µs",
        runs.len(),
        instructions[median],
        instructions[worst],
        cycles[median],
        cycles[worst],
        jitter_cycles as f64 / 168.0,
    );
    assert!(instructions[worst] <= MOST_INSTRUCTIONS);
    assert!(cycles[worst] <= MOST_CYCLES);
    assert!(jitter_cycles <= MOST_JITTER_CYCLES);
    assert!(runs.len() as u32 >= SECONDS * 20_000 - 1);
    bench.board.type_in("stream off\r");
    bench.run(0.01);
    bench.board.terminal.take_answer();
    let status = bench.command("\r");
    assert!(!status.contains("fault"), "{status}");
}

/// Rounds to a whole number of control periods.
fn expected(cycles: u64) -> i64 {
    ((cycles + PERIOD_CYCLES / 2) / PERIOD_CYCLES * PERIOD_CYCLES) as i64
}
