//! `paddle scope`: plots the signals of a board's control loop live in the terminal.

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
use state::{Request, Scope};
use std::io::{IsTerminal, stdout};
use std::time::{Duration, Instant};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle scope --port /dev/ttyUSB0
  paddle scope --port /dev/ttyUSB0 --channels encoder,hall,current --trigger 'encoder 0.1'

Keys: 1 to 7 show or hide a channel, + and - zoom, space holds the picture. Tab chooses a gain, up and down change it by a
tenth. c waits for the trigger and shows 150 ms at 20 kHz around it, l goes back to the stream. After : a line of the
console can be typed, such as `arm` or `step 10`. x stops everything. q and Ctrl-C disarm the paddle and leave.")]
pub struct Arguments {
    /// Serial port of the board, or the terminal that `paddle board` prints.
    #[arg(long)]
    port: String,
    /// Channels shown at the start, separated by commas.
    #[arg(long, default_value = "setpoint,encoder,torque", value_name = "NAMES", value_parser = channels)]
    channels: Channels,
    /// Length of the time axis.
    #[arg(long, default_value_t = 4.0, value_name = "s", value_parser = numbers::positive)]
    window: f64,
    /// Trigger of a capture, as in the console's `capture`: step, now, fault, or a channel and its level.
    #[arg(long, default_value = "step 20", value_name = "TRIGGER")]
    trigger: String,
    /// Rows per second.
    #[arg(long, default_value_t = 500.0, value_name = "Hz", value_parser = numbers::positive)]
    rate: f64,
}

fn channels(text: &str) -> Result<Channels, ChannelsError> {
    Channels::parse(text)
}

/// Time between two frames.
const PICTURE: Duration = Duration::from_millis(50);
/// If the stream sends nothing for this time, the link counts as lost.
const PATIENCE: Duration = Duration::from_secs(2);
/// Interval at which the program asks the board whether the capture is complete.
const LOOK: Duration = Duration::from_millis(300);

/// Runs the scope until the user leaves it.
///
/// # Errors
/// Returns a [`Failure`] if the board does not answer, if the link is lost, and if standard output is not a terminal.
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

/// Stops the stream and hands the disarmed board back to the console.
fn leave(rig: &mut Rig) -> Result<(), DeviceError> {
    rig.device.stop()?;
    rig.device.end_stream()?;
    rig.leave()
}

/// The board, the state of the scope, and the terminal.
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
        while !interrupt.is_requested() {
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
                    && !self.handle_key(key)?
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

    /// Executes the request of a key. Returns false if the user leaves.
    fn handle_key(&mut self, key: event::KeyEvent) -> Result<bool, Failure> {
        match self.scope.press(key) {
            Request::Nothing => {}
            Request::Leave => return Ok(false),
            Request::Stop => self.rig.device.stop()?,
            Request::Stream => self.stream()?,
            Request::Send(line) => {
                let answer = self.rig.device.command(&line)?;
                self.scope.answered(&answer);
            }
            Request::Capture => {
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
