//! A tuning session as a lab would type it, and what the console says to mistakes.

use haptic_paddle::console::{self, Command, ParseError, Refusal, Zero};
use haptic_paddle::controller::{Controller, Measurement, Mode, TickRate};
use haptic_paddle::settings::Settings;

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
        "pid.kp = 0.03 N m/deg at the paddle"
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
fn in_torque_mode_numbers_are_torques() {
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
            .any(|line| line == "metrics.band = 0.2 deg")
    );
}

#[test]
fn words_become_commands() {
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
fn mistakes_are_answered_with_what_to_write() {
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
