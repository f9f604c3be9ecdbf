//! A console session: it processes received bytes, writes text, and checks the wiring before the position loop is armed.

use core::fmt;

use super::answer::VERSION;
use super::complete::Completion;
use super::line::{Edited, LineEditor, STOP_BYTE, Typed};
use super::{Answer, Command, Device, ParseError, Terminal, execute, parse};
use crate::controller::{ArmError, Controller, Mode, StopCause, TickRate, Tuning};
use crate::procedures::{Procedure, ProcedureError, ProcedureKind};
use crate::safety::Fault;
use crate::settings::{Settings, StoreError};
use crate::wiring::{Angles, Progress, WiringCheck};

/// Settling time of the bridge at zero voltage before the current offset is read, s.
const SETTLE_S: f32 = 0.02;
/// Number of control periods over which the current offset is read.
const IDLE_PERIODS: f32 = 1024.0;
/// Largest factor between the measured winding resistance and motor.resistance, in either direction.
const RESISTANCE_FACTOR: f32 = 2.0;

/// The session of one terminal with the settings of the paddle.
#[derive(Debug)]
pub struct Session {
    settings: Settings,
    rate: TickRate,
    ready: Result<(), ArmError>,
    recalled: Result<usize, StoreError>,
    line: LineEditor,
    /// An answer that is not completely written, and the number of its next line.
    answer: Option<(Answer, usize)>,
    arming: Option<Arming>,
    running: Option<Running>,
    wired: bool,
    announced: Option<Fault>,
    bridge_ready: bool,
    /// Time since the last byte from a host program that sends heartbeats, s. `None` without such a program.
    silent_s: Option<f32>,
    /// A new baud rate of the serial line that is not yet set, bit/s.
    baud: Option<u32>,
}

/// State of the arming sequence.
#[derive(Clone, Copy, Debug)]
struct Arming {
    mode: Mode,
    stage: Stage,
    /// The procedure that starts after arming, if any.
    then: Option<ProcedureKind>,
}

/// A running procedure and the time since its start, s.
#[derive(Clone, Debug)]
struct Running {
    procedure: Procedure,
    elapsed_s: f32,
}

/// Stage of the arming sequence.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// The bridge is on at zero voltage, for this remaining time, s.
    Settling(f32),
    /// The offset of the current is measured.
    Reading,
    /// The wiring is checked.
    Checking(WiringCheck),
}

impl Session {
    /// A session with a controller with these settings and rate. `ready` tells whether the board allows arming.
    pub fn new(settings: Settings, rate: TickRate, ready: Result<(), ArmError>) -> Self {
        Self {
            settings,
            rate,
            ready,
            recalled: Err(StoreError::NoStore),
            line: LineEditor::default(),
            answer: None,
            arming: None,
            running: None,
            wired: false,
            announced: None,
            bridge_ready: true,
            silent_s: None,
            baud: None,
        }
    }

    /// Records the result of loading the stored settings: the number of ignored values, or why nothing was loaded.
    pub fn recalled(self, recalled: Result<usize, StoreError>) -> Self {
        Self { recalled, ..self }
    }

    /// The present settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns true if the bridge reported no fault at the last call of [`Self::look`].
    pub fn bridge_is_ready(&self) -> bool {
        self.bridge_ready
    }

    /// Takes the new baud rate, bit/s. It must be set after all pending text has been sent.
    pub fn take_baud(&mut self) -> Option<u32> {
        self.baud.take()
    }

    /// Writes the greeting at power-on.
    pub fn greet(&self, out: &mut impl Terminal) {
        self.introduce(false, out);
        match self.recalled {
            Ok(left_out) => say(out, format_args!("{}", Answer::Loaded(left_out))),
            Err(StoreError::Empty) => say(out, format_args!("{}", Answer::Defaults)),
            Err(error) => say(out, format_args!("the settings are the defaults: {error}")),
        }
        self.prompt(out);
    }

    /// Writes the version, and what prevents arming.
    fn introduce(&self, armed: bool, out: &mut impl Terminal) {
        say(
            out,
            format_args!(
                "\r\n{VERSION}, {}; help lists the commands",
                if armed { "armed" } else { "disarmed" }
            ),
        );
        if let Err(error) = &self.ready {
            say(out, format_args!("{error}"));
        }
    }

    /// Returns true if [`Self::type_in`] accepts more than Ctrl-C. It is false during arming, a procedure or an answer.
    pub fn listens(&self) -> bool {
        self.arming.is_none() && self.running.is_none() && self.answer.is_none()
    }

    /// Continues writing an answer as far as the terminal has room.
    pub fn go_on_saying(&mut self, out: &mut impl Terminal) {
        while let Some((answer, number)) = &mut self.answer
            && out.has_room()
        {
            say(out, format_args!("{}", answer.line(*number)));
            *number += 1;
            if *number >= answer.lines() {
                self.answer = None;
                self.prompt(out);
            }
        }
    }

    /// Writes the prompt, unless an answer or action is still in progress. A line that is being typed is displayed again.
    fn prompt(&self, out: &mut impl fmt::Write) {
        if !self.listens() {
            return;
        }
        ask(out, &self.line.shown());
    }

    /// Processes a received byte. Ctrl-C stops the paddle at once in every state.
    pub fn type_in(&mut self, byte: u8, device: &mut impl Device, out: &mut impl Terminal) {
        if let Some(silent_s) = &mut self.silent_s {
            *silent_s = 0.0;
        }
        if byte == STOP_BYTE {
            device.with(|c| c.stop_at_once(StopCause::Typed));
        } else if !self.listens() {
            return;
        }
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
            Typed::Edited(edited) => {
                show(out, &edited);
                return;
            }
            Typed::Complete(_) => {
                self.complete(out);
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
            Ok(Some(command)) => self.obey(&command, device, out),
            Err(error) => say(out, format_args!("{error}")),
        }
        self.prompt(out);
        self.go_on_saying(out);
    }

    /// Completes the last word, or lists its possible completions.
    fn complete(&mut self, out: &mut impl Terminal) {
        let Edited {
            line,
            behind_cursor,
        } = self.line.shown();
        let begun = line.get(..line.len() - behind_cursor).unwrap_or_default();
        let Ok(begun) = core::str::from_utf8(begun) else {
            return;
        };
        let completion = Completion::of(begun);
        let (rest, only) = completion.rest();
        if rest.is_empty() && !only {
            put(out, format_args!("\r\n"));
            for name in completion.candidates() {
                put(out, format_args!("{name}  "));
            }
            put(out, format_args!("\r\n"));
        } else {
            self.line.insert(rest);
            if only {
                self.line.insert(" ");
            }
        }
        show(out, &self.line.shown());
    }

    /// Reports that received bytes were lost. The line that they belong to is discarded.
    pub fn complain(&mut self, out: &mut impl Terminal) {
        self.line.drop_line();
        say(out, format_args!("\r\ninput lost: send slower"));
        self.prompt(out);
    }

    /// Supervises the controller. It must be called about once per millisecond. `elapsed_s` is the time since the last call,
    /// s.
    pub fn look(&mut self, elapsed_s: f32, device: &mut impl Device, out: &mut impl Terminal) {
        let silent = self.host_is_silent(elapsed_s);
        let seen = device.with(|c| {
            if silent && c.mode() != Mode::Off {
                c.report_fault(Fault::HostSilent);
            }
            Seen {
                fault: c.fault(),
                stopped: c.take_stopped(),
                bridge_ready: c.bridge_ready(),
                off: c.mode() == Mode::Off,
            }
        });
        self.announce(&seen, out);
        if let Some(arming) = self.arming.take() {
            self.go_on(arming, elapsed_s, device, out);
        } else if let Some(running) = self.running.take() {
            self.advance_procedure(running, seen.off, elapsed_s, device, out);
        }
    }

    /// Advances a procedure.
    #[inline(never)]
    fn advance_procedure(
        &mut self,
        mut running: Running,
        off: bool,
        elapsed_s: f32,
        device: &mut impl Device,
        out: &mut impl Terminal,
    ) {
        running.elapsed_s += elapsed_s;
        let name = running.procedure.kind().name();
        let outcome = if off {
            say(
                out,
                format_args!("{name} has not ended, nothing is changed"),
            );
            None
        } else if running.elapsed_s > ProcedureKind::LONGEST_S {
            Some(Err(ProcedureError::TooLong))
        } else {
            match running.procedure.advance(elapsed_s, device) {
                Some(outcome) => Some(outcome),
                None => {
                    self.running = Some(running);
                    return;
                }
            }
        };
        device.with(Controller::disarm);
        match outcome {
            Some(Ok(finding)) => {
                finding.take_over(&mut self.settings);
                say(out, format_args!("{finding}"));
            }
            Some(Err(error)) => say(out, format_args!("{name}: {error}")),
            None => {}
        }
        self.retune(device);
        self.prompt(out);
    }

    /// Puts the settings in force in the controller.
    fn retune(&self, device: &mut impl Device) {
        let tuning = Tuning::new(&self.settings, self.rate);
        device.with(|c| c.retune(tuning));
    }

    /// Returns true if a host program with heartbeats has been silent for too long.
    fn host_is_silent(&mut self, elapsed_s: f32) -> bool {
        let Some(silent_s) = &mut self.silent_s else {
            return false;
        };
        *silent_s += elapsed_s;
        let longest_s = 1e-3 * self.settings.host.heartbeat_ms;
        longest_s > 0.0 && *silent_s > longest_s
    }

    /// Writes what has happened since the last call.
    fn announce(&mut self, seen: &Seen, out: &mut impl Terminal) {
        let disturbed = self.arming.take_if(|_| seen.off);
        let mut said = false;
        if let Some(fault) = seen.fault
            && self.announced != Some(fault)
        {
            self.wired = false;
            say(out, format_args!("\r\nfault: {fault}"));
            said = true;
        }
        self.announced = seen.fault;
        if let Some(cause) = seen.stopped {
            let who = match cause {
                StopCause::Typed => "Ctrl-C",
                StopCause::Button => "the button",
            };
            say(out, format_args!("\r\nstopped by {who}"));
            said = true;
        }
        if let Some(Arming { stage, .. }) = disturbed {
            if let Stage::Checking(check) = stage
                && let Some(Err(error)) = check.verdict()
            {
                say(out, format_args!("{error}"));
            }
            say(out, format_args!("not armed"));
            said = true;
        }
        if seen.bridge_ready != self.bridge_ready {
            self.bridge_ready = seen.bridge_ready;
            if seen.fault == Some(Fault::Bridge) && !seen.bridge_ready {
                // This was already written.
            } else if seen.bridge_ready {
                say(out, format_args!("\r\nthe bridge is ready"));
            } else {
                say(out, format_args!("\r\n{}", ArmError::BridgeNotReady));
            }
            said = true;
        }
        if said {
            self.prompt(out);
        }
    }

    /// Advances the arming sequence.
    fn go_on(
        &mut self,
        arming: Arming,
        elapsed_s: f32,
        device: &mut impl Device,
        out: &mut impl Terminal,
    ) {
        let Arming { mode, stage, then } = arming;
        let next = match stage {
            Stage::Settling(left_s) if left_s > 0.0 => {
                Ok(Some(Stage::Settling(left_s - elapsed_s)))
            }
            Stage::Settling(_) => {
                device.with(Controller::restart_idle);
                Ok(Some(Stage::Reading))
            }
            Stage::Reading => {
                let (wired, limit_nm) = (self.wired, self.settings.motor.torque_limit_nm);
                device.with(|c| {
                    if c.idle().periods() < IDLE_PERIODS {
                        return Ok(Some(Stage::Reading));
                    }
                    c.take_offset().map_err(ArmError::Offset)?;
                    if wired {
                        return Ok(None);
                    }
                    c.arm_for_check()?;
                    Ok(Some(Stage::Checking(WiringCheck::new(angles(c), limit_nm))))
                })
            }
            Stage::Checking(mut check) => {
                match device.with(|c| advance(&mut check, elapsed_s, c)) {
                    Progress::Push(_) => Ok(Some(Stage::Checking(check))),
                    Progress::Done(Err(error)) => Err(ArmError::Wiring(error)),
                    Progress::Done(Ok(())) => self.take_resistance(device).map(|()| None),
                }
            }
        };
        match next {
            Ok(Some(stage)) => self.arming = Some(Arming { mode, stage, then }),
            Ok(None) => {
                self.wired = true;
                match then {
                    None => self.execute(&Command::Arm(mode), device, out),
                    Some(kind) => self.begin(kind, device, out),
                }
                self.prompt(out);
                self.go_on_saying(out);
            }
            Err(error) => {
                device.with(Controller::disarm);
                say(out, format_args!("{error}"));
                self.prompt(out);
            }
        }
    }

    /// Stores the winding resistance that the wiring check measured. It stays unchanged if the motor moved at once, because
    /// the check then gives no value.
    fn take_resistance(&mut self, device: &mut impl Device) -> Result<(), ArmError> {
        let Some(measured_ohm) = device.with(|c| c.resistance_ohm()) else {
            return Ok(());
        };
        let expected_ohm = self.settings.motor.resistance_ohm;
        let factor = measured_ohm / expected_ohm;
        if !(factor > 1.0 / RESISTANCE_FACTOR && factor < RESISTANCE_FACTOR) {
            return Err(ArmError::Resistance {
                measured_ohm,
                expected_ohm,
            });
        }
        self.settings.motor.resistance_ohm = measured_ohm;
        self.retune(device);
        Ok(())
    }

    /// Arms the paddle and starts a procedure.
    fn begin(&mut self, kind: ProcedureKind, device: &mut impl Device, out: &mut impl Terminal) {
        let tuning = Tuning::new(&kind.settings(&self.settings), self.rate);
        let armed = device.with(|c| {
            c.retune(tuning);
            c.arm(kind.mode())
        });
        match armed {
            Ok(()) => {
                self.running = Some(Running {
                    procedure: kind.begin(&self.settings),
                    elapsed_s: 0.0,
                });
            }
            Err(error) => {
                device.with(Controller::disarm);
                self.retune(device);
                say(out, format_args!("{error}"));
            }
        }
    }

    /// Turns the bridge on at zero voltage and starts the arming sequence.
    fn prepare(
        &mut self,
        mode: Mode,
        then: Option<ProcedureKind>,
        device: &mut impl Device,
        out: &mut impl Terminal,
    ) {
        let prepared = self.ready.and_then(|()| device.with(|c| c.prepare(mode)));
        if let Err(error) = prepared {
            say(out, format_args!("{error}"));
            return;
        }
        if !self.wired {
            say(
                out,
                format_args!("checking the wiring: the paddle moves a little"),
            );
        }
        if let Some(kind) = then {
            say(
                out,
                format_args!("{}: let the paddle go; Ctrl-C stops it", kind.name()),
            );
        }
        let stage = Stage::Settling(SETTLE_S);
        self.arming = Some(Arming { mode, stage, then });
    }

    #[inline(never)]
    fn obey(&mut self, command: &Command, device: &mut impl Device, out: &mut impl Terminal) {
        match *command {
            Command::Arm(mode) if mode != Mode::Off => self.prepare(mode, None, device, out),
            Command::Procedure(kind) => self.prepare(kind.mode(), Some(kind), device, out),
            Command::Hello => {
                let armed = device.with(|c| c.mode()) != Mode::Off;
                self.introduce(armed, out);
            }
            _ => {
                match command {
                    Command::Beat(steers) => self.silent_s = steers.then_some(0.0),
                    Command::Baud(baud) => self.baud = Some(*baud),
                    _ => {}
                }
                self.execute(command, device, out);
            }
        }
    }

    #[inline(never)]
    fn execute(&mut self, command: &Command, device: &mut impl Device, out: &mut impl Terminal) {
        match execute(command, &mut self.settings, self.rate, device) {
            Ok(answer) => self.answer = Some((answer, 0)),
            Err(refusal) => say(out, format_args!("{refusal}")),
        }
    }
}

/// State of the controller as [`Session::look`] reads it.
struct Seen {
    fault: Option<Fault>,
    stopped: Option<StopCause>,
    bridge_ready: bool,
    off: bool,
}

fn advance(check: &mut WiringCheck, elapsed_s: f32, controller: &mut Controller) -> Progress {
    let progress = check.advance(elapsed_s, angles(controller));
    match progress {
        // The reference is refused only after a fault, which the next call of [`Session::look`] reports.
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

/// Displays the edited line again in place of the old one.
fn show(out: &mut impl fmt::Write, edited: &Edited) {
    put(out, format_args!("\r\x1b[K"));
    ask(out, edited);
}

/// Writes the prompt and the edited line, with the cursor in place.
fn ask(out: &mut impl fmt::Write, edited: &Edited) {
    let line = core::str::from_utf8(edited.line).unwrap_or("?");
    put(out, format_args!("> {line}"));
    if edited.behind_cursor > 0 {
        put(out, format_args!("\x1b[{}D", edited.behind_cursor));
    }
}

fn say(out: &mut impl fmt::Write, text: fmt::Arguments) {
    put(out, format_args!("{text}\r\n"));
}

/// Writes to a terminal. An error is ignored, because there is no other output to report it on.
fn put(out: &mut impl fmt::Write, text: fmt::Arguments) {
    let _ = out.write_fmt(text);
}
