//! What the scope shows and what a key makes of it: no terminal, no board.

use haptic_paddle::safety::Fault;
use haptic_paddle::settings::Settings;
use link::{Channel, Channels};
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use remote::{Captured, Row};
use std::collections::VecDeque;

/// Control periods a second.
const PERIODS_PER_S: f64 = 20_000.0;
/// Shortest and longest time across the picture, s.
const WINDOW_S: [f64; 2] = [0.1, 30.0];
/// A key changes a gain by this.
const GAIN_FACTOR: f32 = 1.1;
/// The torque mode of the controller, in which the setpoint is a torque.
const TORQUE_MODE: f32 = 2.0;

/// Quantities of one unit, which share a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// Degrees.
    Angle,
    /// Degrees a second.
    Speed,
    /// mN m at the motor.
    Torque,
    /// A.
    Current,
    /// Per cent of the supply.
    Duty,
}

impl Panel {
    /// From top to bottom.
    pub const ALL: [Self; 5] = [
        Self::Angle,
        Self::Speed,
        Self::Torque,
        Self::Current,
        Self::Duty,
    ];

    /// Unit of its axis.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "deg",
            Self::Speed => "deg/s",
            Self::Torque => "mN m",
            Self::Current => "A",
            Self::Duty => "%",
        }
    }

    /// What a value in the unit of its channel is multiplied by.
    fn factor(self) -> f64 {
        match self {
            Self::Angle | Self::Speed => 180.0 / std::f64::consts::PI,
            Self::Torque => 1e3,
            Self::Current => 1.0,
            Self::Duty => 100.0,
        }
    }

    /// The panel of a channel; the setpoint's depends on the mode.
    fn of(channel: Channel, mode: f32) -> Option<Self> {
        Some(match channel {
            Channel::Setpoint if mode == TORQUE_MODE => Self::Torque,
            Channel::Setpoint | Channel::Encoder | Channel::Hall => Self::Angle,
            Channel::Velocity => Self::Speed,
            Channel::Torque => Self::Torque,
            Channel::Current => Self::Current,
            Channel::Duty => Self::Duty,
            Channel::Mode | Channel::Fault => return None,
        })
    }
}

/// A channel in a panel: time and value in the panel's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Which.
    pub channel: Channel,
    /// Where.
    pub panel: Panel,
    /// Time, s since the newest row or the trigger, and value.
    pub points: Vec<(f64, f64)>,
}

/// A gain that keys change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Name of the setting.
    pub name: &'static str,
    /// In the setting's unit.
    pub value: f32,
    /// The first value above 0.
    least: f32,
}

/// What a key asks of the board.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Nothing.
    Nothing,
    /// End the scope.
    Leave,
    /// Stop everything at once.
    Stop,
    /// Other channels.
    Stream,
    /// A line for the console.
    Send(String),
    /// A capture that waits for the trigger.
    Capture,
}

/// The scope.
pub struct Scope {
    /// Channels that are shown.
    pub channels: Channels,
    /// Time across the picture, s.
    pub window_s: f64,
    /// The picture stands still.
    pub held: bool,
    /// The gains, and which of them the keys change.
    pub gains: [Gain; 3],
    /// Index in `gains` of the one that the keys change.
    pub chosen: usize,
    /// A line for the console that is being typed.
    pub line: Option<String>,
    /// What the board said last, or what is to be known.
    pub said: String,
    /// Rows that were lost since the stream began.
    pub lost: u64,
    /// A capture is awaited.
    pub awaits: bool,
    rows: VecDeque<Row>,
    /// Rows that came while the picture stood still.
    waiting: Vec<Row>,
    captured: Option<Captured>,
}

impl Scope {
    /// One that shows `channels` of a board with these `settings`.
    pub fn new(channels: Channels, window_s: f64, settings: &Settings) -> Self {
        let gain = |name, value, least| Gain { name, value, least };
        Self {
            channels,
            window_s: window_s.clamp(WINDOW_S[0], WINDOW_S[1]),
            held: false,
            gains: [
                gain("pid.kp", settings.pid.kp_nm_per_deg, 1e-3),
                gain("pid.ki", settings.pid.ki_nm_per_deg_s, 1e-2),
                gain("pid.kd", settings.pid.kd_nm_s_per_deg, 1e-5),
            ],
            chosen: 0,
            line: None,
            said: String::new(),
            lost: 0,
            awaits: false,
            rows: VecDeque::new(),
            waiting: Vec::new(),
            captured: None,
        }
    }

    /// What is asked of the board: those that are shown, mode and fault.
    pub fn streamed(&self) -> Channels {
        self.channels.with(Channel::Mode).with(Channel::Fault)
    }

    /// What a key does.
    pub fn press(&mut self, key: KeyEvent) -> Wish {
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        if control && matches!(key.code, KeyCode::Char('c' | 'd')) {
            return Wish::Leave;
        }
        if self.line.is_some() {
            return self.type_key(key.code);
        }
        match key.code {
            KeyCode::Char('q') => return Wish::Leave,
            KeyCode::Char('x') => return Wish::Stop,
            KeyCode::Char(':') => self.line = Some(String::new()),
            KeyCode::Char(' ') => self.hold(!self.held),
            KeyCode::Char('+') => self.zoom(0.5),
            KeyCode::Char('-') => self.zoom(2.0),
            KeyCode::Tab => self.chosen = (self.chosen + 1) % self.gains.len(),
            KeyCode::Up => return self.change_gain(GAIN_FACTOR),
            KeyCode::Down => return self.change_gain(1.0 / GAIN_FACTOR),
            KeyCode::Char('c') => {
                self.awaits = true;
                self.captured = None;
                return Wish::Capture;
            }
            KeyCode::Char('l') | KeyCode::Esc => {
                self.captured = None;
                self.hold(false);
            }
            KeyCode::Char(digit @ '1'..='7') => {
                let index = digit as usize - '1' as usize;
                return self.toggle(Channel::ALL[index]);
            }
            _ => {}
        }
        Wish::Nothing
    }

    fn type_key(&mut self, code: KeyCode) -> Wish {
        let Some(line) = &mut self.line else {
            return Wish::Nothing;
        };
        match code {
            KeyCode::Enter => {
                let line = self.line.take().unwrap_or_default();
                if !line.trim().is_empty() {
                    return Wish::Send(line.trim().to_owned());
                }
            }
            KeyCode::Esc => self.line = None,
            KeyCode::Backspace => drop(line.pop()),
            KeyCode::Char(letter) if letter.is_ascii() => line.push(letter),
            _ => {}
        }
        Wish::Nothing
    }

    fn hold(&mut self, held: bool) {
        self.held = held;
        if !held {
            let rows = std::mem::take(&mut self.waiting);
            self.take(rows);
        }
    }

    fn zoom(&mut self, factor: f64) {
        self.window_s = (self.window_s * factor).clamp(WINDOW_S[0], WINDOW_S[1]);
    }

    fn change_gain(&mut self, factor: f32) -> Wish {
        let Gain { name, value, least } = self.gains[self.chosen];
        let value = match value * factor {
            changed if changed >= least => changed,
            _ if factor > 1.0 => least,
            _ => 0.0,
        };
        Wish::Send(format!("set {name} {}", three_digits(value)))
    }

    fn toggle(&mut self, channel: Channel) -> Wish {
        let all = Channel::ALL.into_iter();
        let wanted = all
            .filter(|other| self.channels.has(*other) != (*other == channel))
            .fold(Channels::NONE, Channels::with);
        if wanted.is_empty() {
            return Wish::Nothing;
        }
        self.channels = wanted;
        self.rows.clear();
        self.waiting.clear();
        Wish::Stream
    }

    /// What the board answered to a line; a gain is what the board says that it is.
    pub fn answered(&mut self, answer: &str) {
        for gain in &mut self.gains {
            let told = answer.lines().find_map(|line| {
                let (name, rest) = line.split_once('=')?;
                (name.trim() == gain.name).then_some(rest)
            });
            let value = told.and_then(|told| told.split_ascii_whitespace().next()?.parse().ok());
            gain.value = value.unwrap_or(gain.value);
        }
        self.said = answer.lines().next().unwrap_or_default().to_owned();
    }

    /// New rows of the stream.
    pub fn take(&mut self, rows: Vec<Row>) {
        if self.held {
            self.waiting.extend(rows);
            return;
        }
        self.rows.extend(rows);
        let Some(newest) = self.rows.back().map(|row| row.period) else {
            return;
        };
        let most = (WINDOW_S[1] * PERIODS_PER_S) as u32;
        while (self.rows.front()).is_some_and(|row| newest.wrapping_sub(row.period) > most) {
            self.rows.pop_front();
        }
    }

    /// A capture came; it is shown until a key brings the stream back.
    pub fn show(&mut self, captured: Captured) {
        self.awaits = false;
        self.captured = Some(captured);
    }

    /// Whether a capture is shown.
    pub fn shows_capture(&self) -> bool {
        self.captured.is_some()
    }

    /// What the controller does.
    pub fn mode(&self) -> &'static str {
        match self.latest(Channel::Mode) as u8 {
            0 => "off",
            1 => "idle",
            2 => "torque",
            _ => "position",
        }
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        let number = self.latest(Channel::Fault) as usize;
        number
            .checked_sub(1)
            .and_then(|at| Fault::ALL.get(at).copied())
    }

    fn latest(&self, channel: Channel) -> f32 {
        let newest = self.waiting.last().or(self.rows.back());
        newest.map_or(0.0, |row| row.value(channel))
    }

    /// From and to which time the picture goes, s.
    pub fn span_s(&self) -> [f64; 2] {
        match &self.captured {
            Some(captured) => {
                let [first, last] = [0, captured.samples.len()].map(|at| captured_s(captured, at));
                [first, last]
            }
            None => [-self.window_s, 0.0],
        }
    }

    /// What is drawn, in the order of the channels.
    pub fn traces(&self) -> Vec<Trace> {
        let mode = match &self.captured {
            Some(captured) => captured
                .samples
                .last()
                .map_or(0.0, |sample| sample.value(Channel::Mode)),
            None => self.rows.back().map_or(0.0, |row| row.value(Channel::Mode)),
        };
        let traces = self.channels.iter().filter_map(|channel| {
            let panel = Panel::of(channel, mode)?;
            let points = self.points(channel);
            let points = points.map(|(time_s, value)| (time_s, f64::from(value) * panel.factor()));
            Some(Trace {
                channel,
                panel,
                points: points.filter(|(_, value)| value.is_finite()).collect(),
            })
        });
        traces.collect()
    }

    fn points(&self, channel: Channel) -> Box<dyn Iterator<Item = (f64, f32)> + '_> {
        if let Some(captured) = &self.captured {
            let samples = captured.samples.iter().enumerate();
            return Box::new(
                samples.map(move |(at, sample)| (captured_s(captured, at), sample.value(channel))),
            );
        }
        let newest = self.rows.back().map_or(0, |row| row.period);
        let rows = self.rows.iter().map(move |row| {
            let before_s = f64::from(newest.wrapping_sub(row.period)) / PERIODS_PER_S;
            (-before_s, row.value(channel))
        });
        Box::new(rows.skip_while(|(time_s, _)| *time_s < -self.window_s))
    }
}

/// Time of a sample since the trigger, s.
fn captured_s(captured: &Captured, at: usize) -> f64 {
    (at as f64 - captured.triggered_at() as f64) / PERIODS_PER_S
}

/// As few digits as a gain deserves.
fn three_digits(value: f32) -> f32 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scope() -> Scope {
        let channels = Channels::NONE.with(Channel::Encoder).with(Channel::Torque);
        Scope::new(channels, 2.0, &Settings::default())
    }

    fn row(period: u32, encoder_rad: f32) -> Row {
        Row::new(
            period,
            [
                (Channel::Encoder, encoder_rad),
                (Channel::Torque, 1e-3),
                (Channel::Mode, 3.0),
                (Channel::Fault, 0.0),
            ],
        )
    }

    fn key(code: KeyCode) -> KeyEvent {
        KeyEvent::new(code, KeyModifiers::NONE)
    }

    fn typed(scope: &mut Scope, text: &str) -> Wish {
        for letter in text.chars() {
            assert_eq!(scope.press(key(KeyCode::Char(letter))), Wish::Nothing);
        }
        scope.press(key(KeyCode::Enter))
    }

    #[test]
    fn rows_are_drawn_in_people_s_units_before_the_newest_one() {
        let mut scope = scope();
        scope.take(vec![
            row(0, 0.0),
            row(20_000, 0.1),
            row(40_000, 0.2),
            row(60_000, 0.3),
        ]);
        let traces = scope.traces();
        let [angle, torque] = &traces[..] else {
            panic!("{traces:?}");
        };
        assert_eq!((angle.panel, torque.panel), (Panel::Angle, Panel::Torque));
        // Two seconds are shown.
        let times: Vec<_> = angle.points.iter().map(|(time_s, _)| *time_s).collect();
        assert_eq!(times, [-2.0, -1.0, 0.0]);
        assert!(
            (angle.points[2].1 - 0.3f64.to_degrees()).abs() < 1e-4,
            "{angle:?}"
        );
        assert!((torque.points[0].1 - 1.0).abs() < 1e-4, "{torque:?}");
        assert_eq!((scope.mode(), scope.fault()), ("position", None));
    }

    #[test]
    fn a_gain_goes_up_and_down_and_is_what_the_board_says() {
        let mut scope = scope();
        assert_eq!(
            scope.press(key(KeyCode::Up)),
            Wish::Send("set pid.kp 0.055".into())
        );
        // The board has not said so yet.
        assert_eq!(scope.gains[0].value, 0.05);
        scope.answered("pid.kp = 0.055 N m/deg at the paddle");
        assert_eq!(scope.gains[0].value, 0.055);
        scope.answered("pid.kp is 0 to 2");
        assert_eq!(
            (scope.gains[0].value, scope.said.as_str()),
            (0.055, "pid.kp is 0 to 2")
        );
        // The integral gain is off: the first step turns it on, the way back off.
        scope.press(key(KeyCode::Tab));
        assert_eq!(
            scope.press(key(KeyCode::Up)),
            Wish::Send("set pid.ki 0.01".into())
        );
        scope.answered("pid.ki = 0.01 N m/(deg s)");
        assert_eq!(
            scope.press(key(KeyCode::Down)),
            Wish::Send("set pid.ki 0".into())
        );
    }

    #[test]
    fn channels_come_and_go_and_one_stays() {
        let mut scope = scope();
        assert_eq!(scope.press(key(KeyCode::Char('4'))), Wish::Stream);
        assert_eq!(
            scope.streamed().to_string(),
            "encoder,velocity,torque,mode,fault"
        );
        for digit in ['4', '5'] {
            scope.press(key(KeyCode::Char(digit)));
        }
        assert_eq!(scope.press(key(KeyCode::Char('2'))), Wish::Nothing);
        assert_eq!(scope.channels.to_string(), "encoder");
    }

    #[test]
    fn a_line_is_typed_for_the_console_and_keys_in_it_are_letters() {
        let mut scope = scope();
        scope.press(key(KeyCode::Char(':')));
        assert_eq!(
            typed(&mut scope, "step 10 q"),
            Wish::Send("step 10 q".into())
        );
        assert_eq!(scope.line, None);
        scope.press(key(KeyCode::Char(':')));
        scope.press(key(KeyCode::Esc));
        assert_eq!(scope.press(key(KeyCode::Char('q'))), Wish::Leave);
    }

    #[test]
    fn ctrl_c_leaves_whatever_goes_on() {
        let mut scope = scope();
        scope.press(key(KeyCode::Char(':')));
        let ctrl_c = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(scope.press(ctrl_c), Wish::Leave);
    }

    #[test]
    fn a_picture_that_stands_still_loses_no_row() {
        let mut scope = scope();
        scope.take(vec![row(0, 0.1)]);
        scope.press(key(KeyCode::Char(' ')));
        scope.take(vec![row(20, 0.2)]);
        assert_eq!(scope.traces()[0].points.len(), 1);
        scope.press(key(KeyCode::Char(' ')));
        assert_eq!(scope.traces()[0].points.len(), 2);
    }

    #[test]
    fn a_capture_is_shown_around_its_trigger_until_the_stream_is_wanted_again() {
        let mut scope = scope();
        scope.take(vec![row(0, 0.1)]);
        assert_eq!(scope.press(key(KeyCode::Char('c'))), Wish::Capture);
        assert!(scope.awaits);
        let sample = link::Sample {
            encoder_rad: 0.1,
            mode: 2,
            ..link::Sample::default()
        };
        scope.show(Captured::of(link::Trigger::Step, 400, vec![sample; 3000]));
        assert!(scope.shows_capture() && !scope.awaits);
        assert_eq!(scope.span_s(), [-0.02, 0.13]);
        assert_eq!(scope.traces()[0].points.len(), 3000);
        scope.press(key(KeyCode::Char('l')));
        assert_eq!(scope.traces()[0].points.len(), 1);
    }

    #[test]
    fn old_rows_are_let_go() {
        let mut scope = scope();
        for at in 0..100 {
            scope.take(vec![row(at * 20_000, 0.1)]);
        }
        assert!(scope.rows.len() <= 31, "{}", scope.rows.len());
    }
}
