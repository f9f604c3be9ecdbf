//! Tests of the procedures with the firmware image on the refitted paddle.

use crate::bench::{Bench, image};

/// A bench whose encoder is zeroed.
fn zeroed(test: &str) -> Option<Bench> {
    let mut bench = Bench::new(image(test)?);
    bench.boot();
    bench.command("zero");
    Some(bench)
}

/// Types a line, and waits up to `seconds` for the prompt after its answer.
fn run(bench: &mut Bench, line: &str, seconds: f64) -> String {
    bench.board.type_in(&format!("{line}\r"));
    bench.run(seconds);
    let said = bench.wait_for("\n> ");
    println!("{said}");
    assert!(!bench.drives(), "{said}");
    said
}

/// The first number after a word.
fn number(text: &str, word: &str) -> f64 {
    let rest = text.split(word).nth(1).unwrap_or_else(|| panic!("{text}"));
    let number = rest.trim_start().split([' ', ';', ',', '\r']).next();
    number.unwrap().parse().unwrap_or_else(|_| panic!("{text}"))
}

#[test]
fn the_winding_is_identified() {
    let Some(mut bench) = zeroed("the_winding_is_identified") else {
        return;
    };
    let said = run(&mut bench, "motor id", 2.0);
    assert!(
        (number(&said, "resistance ") / 10.6 - 1.0).abs() < 0.05,
        "{said}"
    );
    assert!(
        (number(&said, "inductance ") / 1.25 - 1.0).abs() < 0.05,
        "{said}"
    );
    assert!(bench.command("get motor.inductance").contains("0.0012"));
}

#[test]
fn the_hall_sensor_is_calibrated() {
    let Some(mut bench) = zeroed("the_hall_sensor_is_calibrated") else {
        return;
    };
    bench.command("set hall.slope 28");
    let said = run(&mut bench, "hall cal", 19.0);
    assert!((number(&said, "deg: ") / 33.0 - 1.0).abs() < 0.01, "{said}");
    assert!((number(&said, "deg/V at ") - 2.4818).abs() < 0.01, "{said}");
}

#[test]
fn the_relay_proposes_gains() {
    let Some(mut bench) = zeroed("the_relay_proposes_gains") else {
        return;
    };
    let said = run(&mut bench, "zn", 4.0);
    assert!((0.02..0.2).contains(&number(&said, "gain ")), "{said}");
    assert!((40.0..110.0).contains(&number(&said, "period ")), "{said}");
    assert!(bench.command("get kp").contains("= 0.05 "), "only proposed");
}

#[test]
fn friction_is_measured() {
    let Some(mut bench) = zeroed("friction_is_measured") else {
        return;
    };
    let said = run(&mut bench, "friction", 36.0);
    // Friction levels of the refit, and its static share.
    assert!(
        (number(&said, "forward ") / (0.585 * 1.08) - 1.0).abs() < 0.1,
        "{said}"
    );
    assert!(
        (number(&said, "backward ") / (0.375 * 1.08) - 1.0).abs() < 0.1,
        "{said}"
    );
}

#[test]
fn ctrl_c_ends_a_procedure_with_the_bridge_off_and_the_users_settings_in_force() {
    let Some(mut bench) = zeroed("ctrl_c_ends_a_procedure") else {
        return;
    };
    for line in ["friction", "hall cal", "motor id", "zn"] {
        bench.board.type_in(&format!("{line}\r"));
        bench.run(0.6);
        assert!(bench.drives(), "{line}");
        bench.board.type_in("\x03");
        bench.run(0.002);
        assert!(!bench.drives(), "{line}");
        let said = bench.wait_for("\n> ");
        assert!(said.contains("nothing is changed"), "{line}: {said}");
    }
    bench.command("arm");
    bench.command("ref 10");
    bench.run(0.5);
    let status = bench.command("status");
    assert!(
        status.contains("mode position") && !status.contains("fault"),
        "{status}"
    );
    let position = status.split("zeroed, position ").nth(1).unwrap_or_default();
    let position_deg: f64 = position.split(' ').next().unwrap().parse().unwrap();
    assert!((position_deg - 10.0).abs() < 1.0, "{status}");
}
