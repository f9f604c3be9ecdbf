//! Tests of a typical tuning session and of the messages about wrong input.

use haptic_paddle::console::{self, Command, MAX_ANSWER_BYTES, ParseError, Refusal, Zero};
use haptic_paddle::controller::{Controller, Measurement, Mode, TickRate};
use haptic_paddle::settings::{FIELDS, Settings};

const RATE: TickRate = TickRate::new(20_000.0, 2);
const AT_ZERO: Measurement = Measurement {
    encoder_count: 0,
    hall_adc: 2032,
    current_adc: 2048.0,
};

struct Session {
    settings: Settings,
    controller: Controller,
}

impl Session {
    fn new() -> Self {
        let settings = Settings::default();
        let mut controller = Controller::new(&settings, RATE);
        controller.step(&AT_ZERO);
        Self {
            settings,
            controller,
        }
    }

    fn say(&mut self, line: &str) -> String {
        let answered = console::parse(line.as_bytes())
            .map_err(Refusal::from)
            .and_then(|command| {
                console::execute(
                    &command.unwrap(),
                    &mut self.settings,
                    RATE,
                    &mut self.controller,
                )
            });
        for _ in 0..2 {
            self.controller.step(&AT_ZERO);
        }
        answered.map_or_else(|refusal| refusal.to_string(), |answer| answer.to_string())
    }
}

#[test]
fn a_session_from_gains_to_a_step() {
    let mut session = Session::new();
    assert_eq!(
        session.say("set kp 0.03"),
        "pid.kp = 0.03 N m/deg at the paddle"
    );
    assert_eq!(
        session.say("get pid.kp"),
        "pid.kp = 0.03 N m/deg at the paddle (0 to 2)"
    );
    assert!(session.say("arm").contains("no zero"));
    assert!(session.say("zero").contains("zeroed"));
    assert!(session.say("arm").starts_with("mode position"));
    session.say("ref 1.5");
    assert!((session.controller.setpoint_rad().to_degrees() - 1.5).abs() < 1e-5);
    session.say("step 10");
    assert!((session.controller.setpoint_rad().to_degrees() - 11.5).abs() < 1e-5);
    let torque_nm = 0.03 * 11.5 / 15.0;
    assert!((session.controller.torque_command_nm() - torque_nm).abs() < 1e-6);
    let status = session.say("status");
    assert!(
        status.contains("setpoint 11.500 deg") && status.contains("rise never"),
        "{status}"
    );
    assert!(session.say("disarm").starts_with("mode off"));
}

#[test]
fn setpoints_are_torques_in_torque_mode() {
    let mut session = Session::new();
    session.say("arm torque");
    session.say("start sine 0.0011 1 12");
    assert!(session.controller.excited());
    session.say("ref 0.001");
    assert_eq!(session.controller.torque_command_nm(), 0.001);
    assert!(
        !session.controller.excited(),
        "a reference ends the test signal"
    );
}

#[test]
fn help_and_get_list_everything() {
    let mut session = Session::new();
    let help = session.say("help");
    for name in [
        "help", "get", "set", "arm", "disarm", "zero", "ref", "step", "status",
    ] {
        assert!(help.lines().any(|line| line.starts_with(name)), "{name}");
    }
    assert!(
        session
            .say("get")
            .lines()
            .any(|line| line == "metrics.band = 0.2 deg (0.001 to 90)")
    );
}

#[test]
fn words_are_parsed_to_commands() {
    let parse = |line: &str| console::parse(line.as_bytes());
    assert_eq!(parse("  \t "), Ok(None));
    assert_eq!(parse("arm torque\r"), Ok(Some(Command::Arm(Mode::Torque))));
    assert_eq!(parse("zero hall"), Ok(Some(Command::Zero(Zero::Hall))));
    assert_eq!(
        parse("zero -3.5"),
        Ok(Some(Command::Zero(Zero::At { angle_deg: -3.5 })))
    );
}

#[test]
fn unambiguous_abbreviations_of_names_are_accepted() {
    let mut session = Session::new();
    assert_eq!(session.say("stat"), session.say("status"));
    assert_eq!(session.say("se h.ce 2.4"), "hall.centre = 2.4 V");
    assert_eq!(session.say("set est.sens hall"), "estimate.sensor = hall");
    let complaint = |line: &[u8]| console::parse(line).unwrap_err().to_string();
    assert_eq!(
        complaint(b"st"),
        "write more of the command, it may be step or start"
    );
    assert_eq!(
        complaint(b"set pid.k 1"),
        "write more of the name, it may be pid.kp pid.ki pid.kd"
    );
}

#[test]
fn get_shows_a_setting_a_group_or_all_with_allowed_values() {
    let mut session = Session::new();
    let group = session.say("get pid");
    assert_eq!(group.lines().count(), 6, "{group}");
    assert!(
        group.lines().all(|line| line.starts_with("pid.")),
        "{group}"
    );
    assert_eq!(
        session.say("get pid.derivative"),
        "pid.derivative = auto (auto, position, observer)"
    );
    assert_eq!(session.say("get").lines().count(), FIELDS.len());
}

#[test]
fn help_describes_a_command_and_a_setting() {
    let mut session = Session::new();
    let set = session.say("help set");
    assert!(
        set.contains("NAME VALUE") && set.contains("example: set"),
        "{set}"
    );
    let kp = session.say("help kp");
    assert!(
        kp.contains("0 to 2") && kp.contains("default 0.05") && kp.contains("Proportional gain"),
        "{kp}"
    );
    assert!(session.say("help nothing").contains("no such"));
}

#[test]
fn every_example_is_parsed() {
    for usage in &console::COMMANDS {
        let parsed = console::parse(usage.example.as_bytes());
        assert!(
            matches!(parsed, Ok(Some(_))),
            "{}: {parsed:?}",
            usage.example
        );
    }
}

#[test]
fn typing_the_output_of_dump_restores_the_settings() {
    let mut session = Session::new();
    for line in [
        "set kp 0.0123",
        "set motor.inductance 1.234e-6",
        "set compensation.dry on",
    ] {
        session.say(line);
    }
    let dump = session.say("dump");
    let mut other = Session::new();
    for line in dump.lines() {
        assert!(line.len() <= console::MAX_LINE_BYTES, "{line}");
        other.say(line);
    }
    assert_eq!(other.settings, session.settings, "{dump}");
}

#[test]
fn comments_are_ignored() {
    let parse = |line: &str| console::parse(line.as_bytes());
    assert_eq!(parse("# set kp 1"), Ok(None));
    assert_eq!(parse("status # or so"), Ok(Some(Command::Status)));
}

#[test]
fn no_line_of_an_answer_is_too_long_for_the_terminal() {
    let mut session = Session::new();
    for line in ["help", "help pid", "get", "dump", "faults", "status"] {
        let answer = session.say(line);
        for line in answer.lines() {
            assert!(line.len() < MAX_ANSWER_BYTES / 2, "{} {line}", line.len());
        }
    }
}

#[test]
fn errors_state_the_correct_input() {
    let complaint = |line: &[u8]| console::parse(line).unwrap_err().to_string();
    assert_eq!(complaint(b"lift"), "no such command: help lists them");
    assert_eq!(complaint(b"disarm now"), "write disarm alone");
    assert_eq!(complaint(b"ref"), "write ref VALUE");
    assert_eq!(complaint(b"ref nan"), "write ref VALUE");
    assert_eq!(complaint(b"set kp"), "write set NAME VALUE");
    assert_eq!(
        complaint(b"set kp lots"),
        "pid.kp must be a number from 0 to 2 N m/deg at the paddle"
    );
    assert!(complaint(b"start chirp 5 1").starts_with("write start step A [S]"));
    assert_eq!(console::parse(&[b'a'; 81]), Err(ParseError::TooLong));
    assert_eq!(console::parse(b"kp \xff"), Err(ParseError::NotText));
}
