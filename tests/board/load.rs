//! Full load of the firmware by terminal input.

use crate::bench::Bench;

/// Keeps the serial port busy in both directions for one second, in position mode with a moving setpoint. A dump of all
/// settings and an answer occupy the line for 29 ms, and they are requested every 30 ms. Most commands access the
/// controller.
pub fn load(bench: &mut Bench, second: u32) {
    const TURNS: usize = 34;
    let commands = [
        "step 1".into(),
        "set estimate.order second".into(),
        format!("start multisine 5 {}", 1 + second % 3),
        format!("set kp 0.0{}", 50 + second % 10),
        "status".into(),
        "set compensation.dry on".into(),
        "set compensation.viscous on".into(),
        "set compensation.gravity on".into(),
        "set compensation.dry off".into(),
    ];
    for turn in 0..TURNS {
        bench
            .board
            .type_in(&format!("get\r{}\r", commands[turn % commands.len()]));
        bench.run(1.0 / TURNS as f64);
    }
}
