//! As much work for the firmware as a terminal can make.

use crate::bench::Bench;

/// Keeps the serial port busy both ways for a second, in position mode with a moving setpoint. A dump of all settings
/// and an answer take 29 ms of the line, and so much is asked for every 30 ms; most commands have the controller lent
/// out.
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
