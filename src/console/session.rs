//! A console session: typed bytes in, text out, and the wiring check that goes before the position loop.

use core::fmt;

use super::line::{LineEditor, Typed};
use super::{Command, Lender, ParseError, execute, parse};
use crate::controller::{ArmError, Controller, Mode, TickRate};
use crate::safety::Fault;
use crate::settings::Settings;
use crate::wiring::{Angles, Progress, WiringCheck};

/// Somebody at a terminal, and the paddle that they tune.
#[derive(Debug)]
pub struct Session {
    settings: Settings,
    rate: TickRate,
    ready: Result<(), ArmError>,
    line: LineEditor,
    check: Option<WiringCheck>,
    wired: bool,
    announced: Option<Fault>,
}

impl Session {
    /// A session with a controller of these settings and rate, on a board that is ready to be armed or not.
    pub fn new(settings: Settings, rate: TickRate, ready: Result<(), ArmError>) -> Self {
        Self {
            settings,
            rate,
            ready,
            line: LineEditor::default(),
            check: None,
            wired: false,
            announced: None,
        }
    }

    /// The settings as they are now.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Says hello.
    pub fn greet(&self, out: &mut impl fmt::Write) {
        say(
            out,
            format_args!(
                "\r\nhaptic paddle {}, disarmed; help lists the commands",
                env!("CARGO_PKG_VERSION")
            ),
        );
        if let Err(error) = &self.ready {
            say(out, format_args!("{error}"));
        }
        prompt(out);
    }

    /// Whether [`Self::type_in`] may be called: not while the wiring is being checked.
    pub fn listens(&self) -> bool {
        self.check.is_none()
    }

    /// Takes a typed byte.
    pub fn type_in(&mut self, byte: u8, controller: &mut impl Lender, out: &mut impl fmt::Write) {
        let command = match self.line.push(byte) {
            Typed::Added(byte) => {
                let shown = if byte.is_ascii_graphic() || byte == b' ' {
                    char::from(byte)
                } else {
                    '?'
                };
                put(out, format_args!("{shown}"));
                return;
            }
            Typed::Erased => {
                put(out, format_args!("\x08 \x08"));
                return;
            }
            Typed::Ignored => return,
            Typed::Dropped => Ok(None),
            Typed::TooLong => Err(ParseError::TooLong),
            Typed::Line(line) => parse(line),
        };
        put(out, format_args!("\r\n"));
        match command {
            Ok(None) => {}
            Ok(Some(command)) => self.obey(&command, controller, out),
            Err(error) => say(out, format_args!("{error}")),
        }
        if self.listens() {
            prompt(out);
        }
    }

    /// Says that typed bytes were lost; the line that they belong to is dropped.
    pub fn complain(&mut self, out: &mut impl fmt::Write) {
        self.line = LineEditor::default();
        say(out, format_args!("\r\ninput lost: send slower"));
        prompt(out);
    }

    /// Looks after the controller; to be called about once a millisecond, with the time since the last call, s.
    pub fn look(
        &mut self,
        elapsed_s: f32,
        controller: &mut impl Lender,
        out: &mut impl fmt::Write,
    ) {
        let fault = controller.with(|c| c.fault());
        if let Some(fault) = fault
            && self.announced != Some(fault)
        {
            self.wired = false;
            let checking = self.check.take().is_some();
            say(out, format_args!("\r\nfault: {fault}"));
            if checking {
                say(out, format_args!("wiring not checked, disarmed"));
            }
            prompt(out);
        }
        self.announced = fault;
        if let Some(mut check) = self.check.take() {
            match controller.with(|c| advance(&mut check, elapsed_s, c)) {
                Progress::Push(_) => self.check = Some(check),
                Progress::Done(Err(error)) => {
                    say(out, format_args!("{error}"));
                    prompt(out);
                }
                Progress::Done(Ok(())) => {
                    self.wired = true;
                    self.obey(&Command::Arm(Mode::Position), controller, out);
                    prompt(out);
                }
            }
        }
    }

    fn obey(&mut self, command: &Command, controller: &mut impl Lender, out: &mut impl fmt::Write) {
        if let Command::Arm(mode) = *command
            && mode != Mode::Off
        {
            if let Err(error) = &self.ready {
                return say(out, format_args!("{error}"));
            }
            if mode == Mode::Position && !self.wired {
                return match controller.with(|c| self.begin_check(c)) {
                    Ok(()) => say(
                        out,
                        format_args!("checking the wiring: the paddle moves a little"),
                    ),
                    Err(error) => say(out, format_args!("{error}")),
                };
            }
        }
        match execute(command, &mut self.settings, self.rate, controller) {
            Ok(answer) => say(out, format_args!("{answer}")),
            Err(refusal) => say(out, format_args!("{refusal}")),
        }
    }

    fn begin_check(&mut self, controller: &mut Controller) -> Result<(), ArmError> {
        if !controller.zeroed() {
            return Err(ArmError::NotZeroed);
        }
        controller.arm(Mode::Torque)?;
        let limit_nm = self.settings.motor.torque_limit_nm;
        self.check = Some(WiringCheck::new(angles(controller), limit_nm));
        Ok(())
    }
}

fn advance(check: &mut WiringCheck, elapsed_s: f32, controller: &mut Controller) -> Progress {
    let progress = check.advance(elapsed_s, angles(controller));
    match progress {
        // Refused only when a fault has just disarmed; the next look announces that.
        Progress::Push(torque_nm) => {
            let _ = controller.set_reference(torque_nm);
        }
        Progress::Done(_) => controller.disarm(),
    }
    progress
}

fn angles(controller: &Controller) -> Angles {
    Angles {
        encoder_rad: controller.encoder_rad(),
        hall_rad: controller.hall_rad(),
    }
}

fn say(out: &mut impl fmt::Write, text: fmt::Arguments) {
    put(out, format_args!("{text}\r\n"));
}

fn prompt(out: &mut impl fmt::Write) {
    put(out, format_args!("> "));
}

/// Writes to a terminal that may be full or gone; there is nobody else to tell.
fn put(out: &mut impl fmt::Write, text: fmt::Arguments) {
    let _ = out.write_fmt(text);
}
