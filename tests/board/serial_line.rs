//! Tests of a disturbed serial line.

use crate::bench::{Bench, image};
use virtual_board::board::Bridge;
use virtual_board::peripherals::usart::Line;

#[test]
fn noise_on_the_line_does_not_lose_a_disarm_command() {
    let Some(image) = image("noise_on_the_line_drops_no_disarm") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.board.set_line(Line::Noisy);
    let answer = bench.command("disarm");
    assert!(answer.contains("mode off"), "{answer}");
    assert_eq!(bench.board.bridge(), Bridge::Off);
    bench.board.set_line(Line::Quiet);
    let faults = bench.command("faults");
    let noise = faults.split("serial noise ").nth(1).unwrap();
    assert!(!noise.starts_with('0'), "{faults}");
}

#[test]
fn an_undriven_input_receives_nothing() {
    let Some(image) = image("an_input_that_nobody_drives") else {
        return;
    };
    let mut bench = Bench::armed(image);
    bench.board.cut_serial();
    bench.board.terminal.take_answer();
    bench.run(0.1);
    let said = bench.board.terminal.take_answer();
    assert_eq!(String::from_utf8_lossy(&said), "");
}
