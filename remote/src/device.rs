//! The board: commands with their answers, and what it streams.

use haptic_paddle::settings::Settings;
use link::{Body, Channel, Channels, Heard, Sequence, Splitter};

use crate::DeviceError;
use crate::capture::Captured;
use crate::wire::{BOOT_BAUD, FAST_BAUD, Wire};

/// Longest wait for a sign of the board, s.
const PATIENCE_S: f64 = 3.0;
/// Longest wait for a prompt at a rate that may be the wrong one, s.
const RATE_PATIENCE_S: f64 = 0.3;
/// The board hears from a program that steers it this often, s: twenty times within its `host.heartbeat`, as a computer
/// pauses now and then.
const BEAT_S: f64 = 0.01;
/// The board says why it stopped within this time, s: a few looks of its console.
const SPEECH_S: f64 = 0.05;
/// Takes the last character of an empty line away: a sign of life that changes nothing.
const BACKSPACE: u8 = 0x08;
/// Drops the line.
const DROP_LINE: u8 = 0x15;
/// Ctrl-C, which stops everything at once.
const STOP: u8 = 0x03;
/// So often a board is looked for.
const TRIALS: usize = 9;
const PROMPT: &str = "> ";

/// A row of the stream; NaN for channels that were not asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Control period at which it begins.
    pub period: u32,
    values: [f32; Channel::ALL.len()],
}

impl Row {
    /// A row of these channels.
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

/// A board on a line.
pub struct Device<W: Wire> {
    wire: W,
    splitter: Splitter,
    sequence: Sequence,
    /// The console's since the last command.
    text: String,
    /// The stream's since they were taken.
    rows: Vec<Row>,
    /// Rows that the board could not send.
    dropped: u32,
    captured: Captured,
    /// Whether the board waits for signs of life.
    steering: bool,
    sent_s: f64,
    other_version: Option<u8>,
    travel_rad: f32,
}

impl<W: Wire> Device<W> {
    /// Finds the board at the other end, whatever rate it was left at.
    ///
    /// # Errors
    /// [`DeviceError::Silent`] if nobody answers.
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
        // A board that was left at another rate comes back to its own after some bytes that it does not understand.
        // One that has just got its power may still be at its boot.
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

    /// Sends a line, and gives the answer, without the echo and the prompt.
    ///
    /// # Errors
    /// [`DeviceError`] if the line is gone or the board silent.
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

    /// As [`Self::command`], for an answer that has `part` in it if the board obeys.
    ///
    /// # Errors
    /// [`DeviceError::Refused`] for another one, too.
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

    /// Changes the rate of both ends to that of a stream.
    ///
    /// # Errors
    /// [`DeviceError`] if the board is not to be found there.
    pub fn speed_up(&mut self) -> Result<(), DeviceError> {
        self.expect(&format!("baud {FAST_BAUD}"), "baud")?;
        self.change_baud(FAST_BAUD)
    }

    /// Changes the rate of both ends to that at which a board boots, so that a terminal finds it.
    ///
    /// # Errors
    /// [`DeviceError`] if the board is not to be found there.
    pub fn slow_down(&mut self) -> Result<(), DeviceError> {
        self.expect(&format!("baud {BOOT_BAUD}"), "baud")?;
        self.change_baud(BOOT_BAUD)
    }

    fn change_baud(&mut self, baud: u32) -> Result<(), DeviceError> {
        // The prompt is out; its last bit is in a moment.
        self.wait(0.01, |_| false)?;
        self.wire.set_baud(baud)?;
        self.command("").map(drop)
    }

    /// From now on the board disarms if nothing is heard of this program, or no longer.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn steer(&mut self, on: bool) -> Result<(), DeviceError> {
        self.expect(if on { "beat" } else { "beat off" }, "beat")?;
        self.steering = on;
        Ok(())
    }

    /// The board's settings, as they are now.
    ///
    /// # Errors
    /// [`DeviceError::Refused`] for a line that is no setting of this program's.
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

    /// How far the paddle may go to either side, by the settings that were read last, rad.
    pub fn travel_rad(&self) -> f32 {
        self.travel_rad
    }

    /// Stops everything at once, and lets the board say so.
    ///
    /// # Errors
    /// As [`Self::listen`].
    pub fn stop(&mut self) -> Result<(), DeviceError> {
        self.send(&[STOP])?;
        self.let_it_speak()
    }

    /// Waits until the board has said by itself why it stopped: in the middle of a command's echo, that would tear it.
    ///
    /// # Errors
    /// As [`Self::listen`].
    pub fn let_it_speak(&mut self) -> Result<(), DeviceError> {
        self.text.clear();
        self.wait(SPEECH_S, |device| device.text.ends_with(PROMPT))?;
        Ok(())
    }

    /// Begins a stream.
    ///
    /// # Errors
    /// [`DeviceError::Refused`] for one that the line does not carry.
    pub fn stream(&mut self, channels: Channels, rate_hz: f64) -> Result<(), DeviceError> {
        self.rows.clear();
        self.dropped = 0;
        self.sequence = Sequence::default();
        self.expect(&format!("stream {channels} {rate_hz}"), "rows lost")?;
        Ok(())
    }

    /// Ends it.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn end_stream(&mut self) -> Result<(), DeviceError> {
        self.expect("stream off", "no stream").map(drop)
    }

    /// Listens once, and gives signs of life.
    ///
    /// # Errors
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

    /// The rows since the last call.
    pub fn take_rows(&mut self) -> Vec<Row> {
        std::mem::take(&mut self.rows)
    }

    /// Rows and other frames that were lost since the stream began.
    pub fn lost(&self) -> u64 {
        self.sequence.lost() + u64::from(self.dropped)
    }

    /// What the console said since the last command.
    pub fn said(&self) -> &str {
        &self.text
    }

    /// Time by the line, s.
    pub fn time_s(&self) -> f64 {
        self.wire.time_s()
    }

    /// Fetches the complete capture.
    ///
    /// # Errors
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

    /// Listens for so long, s, and gives signs of life.
    ///
    /// # Errors
    /// As [`Self::listen`].
    pub fn wait_s(&mut self, seconds: f64) -> Result<(), DeviceError> {
        let end_s = self.wire.time_s() + seconds;
        while self.wire.time_s() < end_s {
            self.listen()?;
        }
        Ok(())
    }

    /// Gives the wire back.
    pub fn into_wire(self) -> W {
        self.wire
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        self.sent_s = self.wire.time_s();
        Ok(self.wire.write(bytes)?)
    }

    /// Listens until `done`, or until nothing was heard for so long. Returns whether it is done.
    pub(crate) fn wait(
        &mut self,
        patience_s: f64,
        done: impl Fn(&Self) -> bool,
    ) -> Result<bool, DeviceError> {
        let mut heard_s = self.wire.time_s();
        while !done(self) {
            // Rows are no answer.
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
