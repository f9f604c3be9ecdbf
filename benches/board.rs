//! Benchmark of the firmware image on the virtual board: its speed, and one minute at full load.

#[expect(dead_code, reason = "the tests use more of it")]
#[path = "../tests/board/bench.rs"]
mod bench;
#[path = "../tests/board/load.rs"]
mod load;

use bench::{Bench, CONTROL};
use rustix::time::{ClockId, clock_gettime};

const MINUTE_S: u32 = 60;
const PERIOD_CYCLES: u64 = 8_400;
const CYCLES_PER_US: f64 = 168.0;
/// Stream command at full load. The board arms the capture of a fault by itself.
const STREAM: &str = "stream setpoint,encoder,hall,velocity,torque,current 2000";
/// Time until the board has read that command, s. Frames follow its answer, so the terminal shows no prompt at the end.
const STREAM_STARTS_S: f64 = 0.05;

fn main() {
    let Some(image) = bench::image("board") else {
        return;
    };
    let mut bench = Bench::armed(image);
    measure(&mut bench, "position loop, quiet terminal", |bench| {
        for _ in 0..MINUTE_S {
            bench.command("step 5");
            bench.run(0.5);
            bench.command("ref 0");
            bench.run(0.4);
        }
    });
    bench.speed_up();
    bench.board.type_in(&format!("{STREAM}\r"));
    bench.run(STREAM_STARTS_S);
    bench.board.cpu.record_activations(true);
    let mut first = None;
    let mut waits = (u64::MAX, 0);
    let mut count = 0;
    measure(&mut bench, "full load", |bench| {
        for second in 0..MINUTE_S {
            load::load(bench, second);
            bench.board.terminal.take_answer();
            for run in bench.board.cpu.take_activations() {
                if run.exception == CONTROL {
                    let first = *first.get_or_insert(run.entered);
                    // Phase relative to the start of the control period, except for a constant.
                    let phase = (run.entered + PERIOD_CYCLES / 2 - first) % PERIOD_CYCLES;
                    waits = (waits.0.min(phase), waits.1.max(phase));
                    count += 1;
                    let missed =
                        (run.entered + PERIOD_CYCLES / 2 - first) / PERIOD_CYCLES + 1 - count;
                    assert_eq!(missed, 0, "control interrupts missed");
                }
            }
        }
    });
    println!(
        "{count} control interrupts in {MINUTE_S} s at full load, none missed; the start varies by {:.3} µs",
        (waits.1 - waits.0) as f64 / CYCLES_PER_US
    );
    let totals = bench.board.cpu.totals(CONTROL);
    println!(
        "each {:.0} instructions and {:.0} model cycles in the mean, {} and {} at most",
        totals.instructions as f64 / totals.count as f64,
        totals.cycles as f64 / totals.count as f64,
        totals.most_instructions,
        totals.most_cycles
    );
}

/// Runs `work` and prints its speed.
fn measure(bench: &mut Bench, what: &str, work: impl FnOnce(&mut Bench)) {
    let (from_s, from) = (bench.board.time_s(), bench.board.cpu.instructions());
    let began_s = processor_s();
    work(bench);
    let took_s = processor_s() - began_s;
    let seconds = bench.board.time_s() - from_s;
    let instructions = (bench.board.cpu.instructions() - from) as f64;
    println!(
        "{what}: {seconds:.0} s in {took_s:.1} s of one core, {:.1} times real time, {:.0} million instructions a second",
        seconds / took_s,
        1e-6 * instructions / took_s
    );
}

/// Processor time that this program has used, s.
fn processor_s() -> f64 {
    let used = clock_gettime(ClockId::ProcessCPUTime);
    used.tv_sec as f64 + 1e-9 * used.tv_nsec as f64
}
