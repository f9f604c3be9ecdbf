//! `paddle scope`: what a board's loop does, drawn in the terminal as it happens.

mod state;
mod view;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::numbers;
use crate::progress;
use crate::rig::Rig;
use clap::Args;
use link::{Channels, ChannelsError};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event};
use remote::DeviceError;
use serde_json::json;
use state::{Scope, Wish};
use std::io::{IsTerminal, stdout};
use std::time::{Duration, Instant};

/// Which board, and what of it.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle scope --port /dev/ttyUSB0
  paddle scope --port /dev/ttyUSB0 --channels encoder,hall,current --trigger 'encoder 0.1'

Keys: 1 to 7 show or hide a channel, + and - zoom, space holds the picture. Tab chooses a gain, up and down change it by a
tenth. c waits for the trigger and shows 150 ms at 20 kHz around it, l goes back to the stream. After : a line of the
console can be typed, such as `arm` or `step 10`. x stops everything. q and Ctrl-C disarm the paddle and leave.")]
pub struct Arguments {
    /// The serial port, or what `paddle board` says.
    #[arg(long)]
    port: String,
    /// What is shown at first, with commas between.
    #[arg(long, default_value = "setpoint,encoder,torque", value_name = "NAMES", value_parser = channels)]
    channels: Channels,
    /// Time across the picture.
    #[arg(long, default_value_t = 4.0, value_name = "s", value_parser = numbers::positive)]
    window: f64,
    /// What a capture waits for, as after the console's `capture`: step, now, fault, or a channel and its level.
    #[arg(long, default_value = "step 20", value_name = "TRIGGER")]
    trigger: String,
    /// Rows a second.
    #[arg(long, default_value_t = 500.0, value_name = "Hz", value_parser = numbers::positive)]
    rate: f64,
}

fn channels(text: &str) -> Result<Channels, ChannelsError> {
    Channels::parse(text)
}

/// Between two pictures.
const PICTURE: Duration = Duration::from_millis(50);
/// A stream that says nothing for so long is a lost link.
const PATIENCE: Duration = Duration::from_secs(2);
/// How often the board is asked whether the capture is complete.
const LOOK: Duration = Duration::from_millis(300);

/// Shows it until the user leaves.
///
/// # Errors
/// [`Failure`] for a board that does not answer, a link that is lost, and standard output that is no terminal.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    if !stdout().is_terminal() {
        return Err(Failure::Board(
            "paddle scope draws on a terminal, and standard output is none; `paddle record` leaves data".into(),
        ));
    }
    let interrupt = Interrupt::watched()?;
    let mut rig = Rig::open(&arguments.port)?;
    let mut scope = Scope::new(arguments.channels, arguments.window, &rig.settings);
    progress::hide();
    let no_terminal = |error| Failure::Board(format!("cannot draw on this terminal: {error}"));
    let mut terminal = ratatui::try_init().map_err(no_terminal)?;
    let shown = Screen {
        arguments,
        rig: &mut rig,
        scope: &mut scope,
        terminal: &mut terminal,
    }
    .run(&interrupt);
    ratatui::restore();
    let left = leave(&mut rig);
    shown?;
    left?;
    Ok(Answer {
        text: String::new(),
        json: json!({ "rows_lost": scope.lost }),
        ..Answer::default()
    })
}

/// Ends the stream and leaves the board disarmed to a person at a terminal.
fn leave(rig: &mut Rig) -> Result<(), DeviceError> {
    rig.device.stop()?;
    rig.device.end_stream()?;
    rig.leave()
}

/// Board, state and terminal, put together.
struct Screen<'a> {
    arguments: &'a Arguments,
    rig: &'a mut Rig,
    scope: &'a mut Scope,
    terminal: &'a mut DefaultTerminal,
}

impl Screen<'_> {
    fn run(&mut self, interrupt: &Interrupt) -> Result<(), Failure> {
        self.stream()?;
        let mut drawn = Instant::now();
        let mut heard = Instant::now();
        let mut looked = Instant::now();
        while !interrupt.is_wished() {
            self.rig.device.listen()?;
            let rows = self.rig.device.take_rows();
            if !rows.is_empty() {
                heard = Instant::now();
            }
            if heard.elapsed() > PATIENCE {
                return Err(DeviceError::Silent.into());
            }
            self.scope.take(rows);
            self.scope.lost = self.rig.device.lost();
            if self.scope.awaits && looked.elapsed() > LOOK {
                looked = Instant::now();
                self.look_for_capture()?;
            }
            while event::poll(Duration::ZERO).map_err(no_key)? {
                if let Event::Key(key) = event::read().map_err(no_key)?
                    && key.is_press()
                    && !self.obey(key)?
                {
                    return Ok(());
                }
            }
            if drawn.elapsed() > PICTURE {
                drawn = Instant::now();
                self.draw()?;
            }
        }
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Failure> {
        let (scope, port) = (&*self.scope, &self.arguments.port);
        self.terminal
            .draw(|frame| view::draw(frame, scope, port))
            .map_err(|error| Failure::Board(format!("cannot draw on this terminal: {error}")))?;
        Ok(())
    }

    fn stream(&mut self) -> Result<(), DeviceError> {
        self.rig
            .device
            .stream(self.scope.streamed(), self.arguments.rate)
    }

    /// Does what a key asks; false if the user leaves.
    fn obey(&mut self, key: event::KeyEvent) -> Result<bool, Failure> {
        match self.scope.press(key) {
            Wish::Nothing => {}
            Wish::Leave => return Ok(false),
            Wish::Stop => self.rig.device.stop()?,
            Wish::Stream => self.stream()?,
            Wish::Send(line) => {
                let answer = self.rig.device.command(&line)?;
                self.scope.answered(&answer);
            }
            Wish::Capture => {
                let line = format!("capture {}", self.arguments.trigger);
                let answer = self.rig.device.command(&line)?;
                self.scope.awaits = answer.starts_with("capture ");
                self.scope.answered(&answer);
            }
        }
        Ok(true)
    }

    fn look_for_capture(&mut self) -> Result<(), Failure> {
        if self
            .rig
            .device
            .command("capture")?
            .contains("capture complete")
        {
            let captured = self.rig.device.fetch_capture()?;
            self.scope.show(captured);
        }
        Ok(())
    }
}

fn no_key(error: std::io::Error) -> Failure {
    Failure::Board(format!("no keys from this terminal: {error}"))
}
