//! Tests of the boot sequence from power-on to the console.

use crate::bench::{Bench, image};

#[test]
fn the_board_boots_disarmed_within_half_a_second_with_the_bridge_off() {
    let Some(image) = image("boot") else { return };
    let mut bench = Bench::new(image);
    bench.board.record_steps(true);
    let greeting = bench.boot();
    assert!(greeting.contains("disarmed"), "{greeting}");
    println!("console after {:.3} s", bench.board.time_s());
    assert!(bench.board.time_s() < 0.5);
    assert!(
        bench
            .board
            .take_steps()
            .iter()
            .all(|step| step.duty.is_none())
    );
    let log = bench.board.take_log();
    assert!(
        log.iter()
            .any(|entry| entry.level == "INFO" && entry.message == "disarmed, control at 20000 Hz"),
        "{log:?}"
    );
    assert!(log.iter().all(|entry| entry.level != "ERROR"), "{log:?}");
}

#[test]
fn two_runs_are_identical() {
    let Some(image) = image("two_runs_are_identical") else {
        return;
    };
    let run = || {
        let mut bench = Bench::new(image.clone());
        bench.boot();
        bench.board.record_steps(true);
        let said: Vec<_> = ["zero hall", "arm", "step 10", "status"]
            .map(|line| bench.command(line))
            .into();
        (
            said,
            bench.board.take_steps(),
            bench.board.cpu.instructions(),
            bench.board.cpu.signals.cycle(),
        )
    };
    assert!(run() == run());
}

#[test]
fn a_loss_of_the_supply_clears_all_volatile_state() {
    let Some(image) = image("a_loss_of_the_supply_leaves_nothing_behind") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.command("set kp 0.06");
    bench.command("ref 15");
    bench.run(0.005);
    assert!(bench.drives());
    bench.board.interrupt_supply(0.05);
    assert!(!bench.drives());
    let greeting = bench.boot();
    assert!(
        greeting.contains("disarmed") && !greeting.contains("reset"),
        "{greeting}"
    );
    let kp = bench.command("get kp");
    assert!(kp.contains("pid.kp = 0.05 "), "{kp}");
    let refusal = bench.command("arm");
    assert!(refusal.contains("zero"), "{refusal}");
}
