//! The board: commands with their answers, and its stream.

use haptic_paddle::settings::Settings;
use link::{Body, Channel, Channels, Heard, Sequence, Splitter};

use crate::DeviceError;
use crate::capture::Captured;
use crate::wire::{BOOT_BAUD, FAST_BAUD, Wire};

/// Longest wait for an answer of the board, s.
const PATIENCE_S: f64 = 3.0;
/// Longest wait for a prompt at a baud rate that may be wrong, s.
const RATE_PATIENCE_S: f64 = 0.3;
/// Interval of the heartbeats, s. It is a twentieth of the default `host.heartbeat`, because a computer can pause.
const BEAT_S: f64 = 0.01;
/// Time within which the board reports why it stopped, s: a few calls of its console's supervision.
const SPEECH_S: f64 = 0.05;
/// Backspace, which has no effect on an empty line. It serves as a heartbeat.
const BACKSPACE: u8 = 0x08;
/// Discards the line.
const DROP_LINE: u8 = 0x15;
/// Ctrl-C, which stops the paddle at once.
const STOP: u8 = 0x03;
/// Number of attempts to find a board.
const TRIALS: usize = 9;
const PROMPT: &str = "> ";

/// A row of the stream. Channels that were not requested are NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Control period at the beginning of the row.
    pub period: u32,
    values: [f32; Channel::ALL.len()],
}

impl Row {
    /// A row with the values of these channels.
    pub fn new(period: u32, values: impl IntoIterator<Item = (Channel, f32)>) -> Self {
        let mut row = Self {
            period,
            values: [f32::NAN; Channel::ALL.len()],
        };
        for (channel, value) in values {
            row.values[channel as usize] = value;
        }
        row
    }

    /// The value of a channel, in its unit.
    pub fn value(&self, channel: Channel) -> f32 {
        self.values[channel as usize]
    }
}

/// A board on a serial line.
pub struct Device<W: Wire> {
    wire: W,
    splitter: Splitter,
    sequence: Sequence,
    /// Console text since the last command.
    text: String,
    /// Rows of the stream that have not been taken.
    rows: Vec<Row>,
    /// Number of rows that the board could not send.
    dropped: u32,
    captured: Captured,
    /// True if the board expects heartbeats.
    steering: bool,
    sent_s: f64,
    other_version: Option<u8>,
    travel_rad: f32,
}

impl<W: Wire> Device<W> {
    /// Finds the board at the other end of the line, at any baud rate that it may have.
    ///
    /// # Errors
    ///
    /// [`DeviceError::Silent`] if no board answers.
    pub fn find(wire: W) -> Result<Self, DeviceError> {
        let mut device = Self {
            wire,
            splitter: Splitter::default(),
            sequence: Sequence::default(),
            text: String::new(),
            rows: Vec::new(),
            dropped: 0,
            captured: Captured::default(),
            steering: false,
            sent_s: 0.0,
            other_version: None,
            travel_rad: Settings::default().limit.travel_deg.to_radians(),
        };
        // A board at another baud rate returns to its boot rate after some unreadable bytes. A board that was just powered
        // on may still be booting.
        for baud in [BOOT_BAUD, FAST_BAUD, BOOT_BAUD]
            .into_iter()
            .cycle()
            .take(TRIALS)
        {
            device.wire.set_baud(baud)?;
            device.send(&[DROP_LINE; 16])?;
            let quiet = device.wait(RATE_PATIENCE_S, |_| false)?;
            debug_assert!(!quiet);
            device.text.clear();
            device.send(&[DROP_LINE])?;
            if device.wait(RATE_PATIENCE_S, |device| device.text.ends_with(PROMPT))? {
                device.command("stream off")?;
                device.rows.clear();
                return Ok(device);
            }
        }
        Err(DeviceError::Silent)
    }

    /// Sends a line. Returns the answer without echo and prompt.
    ///
    /// # Errors
    ///
    /// [`DeviceError`] if the line is broken or the board does not answer.
    pub fn command(&mut self, line: &str) -> Result<String, DeviceError> {
        self.text.clear();
        self.send(line.as_bytes())?;
        self.send(b"\r")?;
        let echo = format!("{line}\r\n");
        let answered = self.wait(PATIENCE_S, |device| {
            device.text.ends_with(PROMPT) && device.text.contains(&echo)
        })?;
        if !answered {
            return Err(DeviceError::Silent);
        }
        let answer = self.text.split_once(&echo).map_or("", |(_, answer)| answer);
        let answer = answer.strip_suffix(PROMPT).unwrap_or(answer);
        Ok(answer.trim().replace("\r\n", "\n"))
    }

    /// The same as [`Self::command`], for an answer that must contain `part`.
    ///
    /// # Errors
    ///
    /// Also [`DeviceError::Refused`] if the answer does not contain it.
    pub fn expect(&mut self, line: &str, part: &str) -> Result<String, DeviceError> {
        let answer = self.command(line)?;
        if answer.contains(part) {
            return Ok(answer);
        }
        Err(DeviceError::Refused {
            line: line.into(),
            answer: answer.replace('\n', " "),
        })
    }

    /// Changes both ends to the baud rate of a stream.
    ///
    /// # Errors
    ///
    /// [`DeviceError`] if the board does not answer at that rate.
    pub fn speed_up(&mut self) -> Result<(), DeviceError> {
        self.expect(&format!("baud {FAST_BAUD}"), "baud")?;
        self.change_baud(FAST_BAUD)
    }

    /// Changes both ends to the baud rate after boot, so that a terminal can connect.
    ///
    /// # Errors
    ///
    /// [`DeviceError`] if the board does not answer at that rate.
    pub fn slow_down(&mut self) -> Result<(), DeviceError> {
        self.expect(&format!("baud {BOOT_BAUD}"), "baud")?;
        self.change_baud(BOOT_BAUD)
    }

    fn change_baud(&mut self, baud: u32) -> Result<(), DeviceError> {
        // The prompt was received. Its last bit ends shortly.
        self.wait(0.01, |_| false)?;
        self.wire.set_baud(baud)?;
        self.command("").map(drop)
    }

    /// Starts or stops the heartbeat supervision. With it, the board disarms if this program falls silent.
    ///
    /// # Errors
    ///
    /// [`DeviceError`].
    pub fn steer(&mut self, on: bool) -> Result<(), DeviceError> {
        self.expect(if on { "beat" } else { "beat off" }, "beat")?;
        self.steering = on;
        Ok(())
    }

    /// Reads the present settings of the board.
    ///
    /// # Errors
    ///
    /// [`DeviceError::Refused`] for a setting that this program does not know.
    pub fn settings(&mut self) -> Result<Settings, DeviceError> {
        let dump = self.command("dump")?;
        let mut settings = Settings::default();
        for line in dump.lines() {
            let mut words = line.split_ascii_whitespace();
            let (Some("set"), Some(name), Some(value)) = (words.next(), words.next(), words.next())
            else {
                continue;
            };
            if settings.set(name, value).is_err() {
                return Err(DeviceError::Refused {
                    line: "dump".into(),
                    answer: format!(
                        "{line}: not a setting of this program; flash the firmware of the same release"
                    ),
                });
            }
        }
        self.travel_rad = settings.limit.travel_deg.to_radians();
        Ok(settings)
    }

    /// Travel limit to either side from the last settings, rad.
    pub fn travel_rad(&self) -> f32 {
        self.travel_rad
    }

    /// Stops the paddle at once and waits for the board's message.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::listen`].
    pub fn stop(&mut self) -> Result<(), DeviceError> {
        self.send(&[STOP])?;
        self.let_it_speak()
    }

    /// Waits until the board has reported why it stopped. Such a message could otherwise split the echo of a command.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::listen`].
    pub fn let_it_speak(&mut self) -> Result<(), DeviceError> {
        self.text.clear();
        self.wait(SPEECH_S, |device| device.text.ends_with(PROMPT))?;
        Ok(())
    }

    /// Starts a stream.
    ///
    /// # Errors
    ///
    /// [`DeviceError::Refused`] for a stream that exceeds the capacity of the line.
    pub fn stream(&mut self, channels: Channels, rate_hz: f64) -> Result<(), DeviceError> {
        self.rows.clear();
        self.dropped = 0;
        self.sequence = Sequence::default();
        self.expect(&format!("stream {channels} {rate_hz}"), "rows lost")?;
        Ok(())
    }

    /// Stops the stream.
    ///
    /// # Errors
    ///
    /// [`DeviceError`].
    pub fn end_stream(&mut self) -> Result<(), DeviceError> {
        self.expect("stream off", "no stream").map(drop)
    }

    /// Receives once and sends heartbeats.
    ///
    /// # Errors
    ///
    /// [`DeviceError::Gone`], [`DeviceError::Version`].
    pub fn listen(&mut self) -> Result<usize, DeviceError> {
        if self.steering && self.wire.time_s() - self.sent_s >= BEAT_S {
            self.send(&[BACKSPACE])?;
        }
        let mut bytes = [0; 4096];
        let length = self.wire.read(&mut bytes)?;
        for byte in &bytes[..length] {
            match self.splitter.push(*byte) {
                Heard::Nothing | Heard::Corrupt => {}
                Heard::Text(byte) => self.text.push(char::from(byte)),
                Heard::OtherVersion(version) => self.other_version = Some(version),
                Heard::Frame(frame) => {
                    self.sequence.follow(frame.sequence);
                    match frame.body {
                        Body::Row {
                            period,
                            dropped,
                            channels,
                            values,
                        } => {
                            self.dropped = dropped;
                            self.rows
                                .push(Row::new(period, link::values(channels, values)));
                        }
                        body => self.captured.hear(&body),
                    }
                }
            }
        }
        match self.other_version {
            Some(sent) => Err(DeviceError::Version { sent }),
            None => Ok(length),
        }
    }

    /// Takes the rows since the last call.
    pub fn take_rows(&mut self) -> Vec<Row> {
        std::mem::take(&mut self.rows)
    }

    /// Number of rows and other frames that were lost since the stream started.
    pub fn lost(&self) -> u64 {
        self.sequence.lost() + u64::from(self.dropped)
    }

    /// Console text since the last command.
    pub fn said(&self) -> &str {
        &self.text
    }

    /// Time of the line, s.
    pub fn time_s(&self) -> f64 {
        self.wire.time_s()
    }

    /// Reads the complete capture.
    ///
    /// # Errors
    ///
    /// [`DeviceError::Refused`] if there is none.
    pub fn fetch_capture(&mut self) -> Result<Captured, DeviceError> {
        self.captured = Captured::default();
        self.expect("capture send", "complete")?;
        let complete = self.wait(PATIENCE_S, |device| device.captured.is_complete())?;
        if !complete {
            return Err(DeviceError::Silent);
        }
        Ok(std::mem::take(&mut self.captured))
    }

    /// Receives for this time, s, and sends heartbeats.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::listen`].
    pub fn wait_s(&mut self, seconds: f64) -> Result<(), DeviceError> {
        let end_s = self.wire.time_s() + seconds;
        while self.wire.time_s() < end_s {
            self.listen()?;
        }
        Ok(())
    }

    /// Returns the wire.
    pub fn into_wire(self) -> W {
        self.wire
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        self.sent_s = self.wire.time_s();
        Ok(self.wire.write(bytes)?)
    }

    /// Receives until `done` is true, or until nothing was received for this time. Returns true if `done` was reached.
    pub(crate) fn wait(
        &mut self,
        patience_s: f64,
        done: impl Fn(&Self) -> bool,
    ) -> Result<bool, DeviceError> {
        let mut heard_s = self.wire.time_s();
        while !done(self) {
            // Rows of the stream do not count as an answer.
            let before = self.text.len() + self.captured.len();
            self.listen()?;
            let now_s = self.wire.time_s();
            if self.text.len() + self.captured.len() != before {
                heard_s = now_s;
            }
            if now_s - heard_s > patience_s {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
