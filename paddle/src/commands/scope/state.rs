//! State of the scope and the effect of each key. This module uses neither the terminal nor the board.

use haptic_paddle::safety::Fault;
use haptic_paddle::settings::Settings;
use link::{Channel, Channels};
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use remote::{Captured, Row};
use std::collections::VecDeque;

/// Control periods per second.
const PERIODS_PER_S: f64 = 20_000.0;
/// Shortest and longest time axis, s.
const WINDOW_S: [f64; 2] = [0.1, 30.0];
/// Factor by which a key changes a gain.
const GAIN_FACTOR: f32 = 1.1;
/// Number of the controller's torque mode, in which the setpoint is a torque.
const TORQUE_MODE: f32 = 2.0;

/// A plot of all quantities with the same unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// Angle, degrees.
    Angle,
    /// Speed, degrees per second.
    Speed,
    /// Torque, mN m at the motor.
    Torque,
    /// Current, A.
    Current,
    /// Duty cycle, per cent of the supply.
    Duty,
}

impl Panel {
    /// All plots, from top to bottom.
    pub const ALL: [Self; 5] = [
        Self::Angle,
        Self::Speed,
        Self::Torque,
        Self::Current,
        Self::Duty,
    ];

    /// Unit of the vertical axis.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "deg",
            Self::Speed => "deg/s",
            Self::Torque => "mN m",
            Self::Current => "A",
            Self::Duty => "%",
        }
    }

    /// Factor from the unit of the channel to the unit of the plot.
    fn factor(self) -> f64 {
        match self {
            Self::Angle | Self::Speed => 180.0 / std::f64::consts::PI,
            Self::Torque => 1e3,
            Self::Current => 1.0,
            Self::Duty => 100.0,
        }
    }

    /// The plot of a channel. The plot of the setpoint depends on the mode.
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

/// A channel in a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Channel of the trace.
    pub channel: Channel,
    /// Plot of the trace.
    pub panel: Panel,
    /// Time, s since the newest row or since the trigger, and value in the unit of the plot.
    pub points: Vec<(f64, f64)>,
}

/// A gain that keys change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Name of the setting.
    pub name: &'static str,
    /// Value in the unit of the setting.
    pub value: f32,
    /// The smallest value above 0.
    least: f32,
}

/// A request of a key to the program.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// No request.
    Nothing,
    /// Leave the scope.
    Leave,
    /// Stop the motor immediately.
    Stop,
    /// Restart the stream with other channels.
    Stream,
    /// Send a line to the console.
    Send(String),
    /// Start a capture that waits for the trigger.
    Capture,
}

/// State of the scope.
pub struct Scope {
    /// Channels that are shown.
    pub channels: Channels,
    /// Length of the time axis, s.
    pub window_s: f64,
    /// Whether the plots are paused.
    pub held: bool,
    /// The gains that keys can change.
    pub gains: [Gain; 3],
    /// Index in `gains` of the selected gain.
    pub chosen: usize,
    /// The console line that the user is typing.
    pub line: Option<String>,
    /// Last answer of the board, or a hint to the user.
    pub said: String,
    /// Number of rows lost since the stream began.
    pub lost: u64,
    /// Whether a capture is pending.
    pub awaits: bool,
    rows: VecDeque<Row>,
    /// Rows received while the plots are paused.
    waiting: Vec<Row>,
    captured: Option<Captured>,
}

impl Scope {
    /// Creates the state that shows `channels` of a board with these `settings`.
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

    /// Channels requested from the board: the shown channels, the mode and the fault.
    pub fn streamed(&self) -> Channels {
        self.channels.with(Channel::Mode).with(Channel::Fault)
    }

    /// Handles a key.
    pub fn press(&mut self, key: KeyEvent) -> Request {
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        if control && matches!(key.code, KeyCode::Char('c' | 'd')) {
            return Request::Leave;
        }
        if self.line.is_some() {
            return self.type_key(key.code);
        }
        match key.code {
            KeyCode::Char('q') => return Request::Leave,
            KeyCode::Char('x') => return Request::Stop,
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
                return Request::Capture;
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
        Request::Nothing
    }

    fn type_key(&mut self, code: KeyCode) -> Request {
        let Some(line) = &mut self.line else {
            return Request::Nothing;
        };
        match code {
            KeyCode::Enter => {
                let line = self.line.take().unwrap_or_default();
                if !line.trim().is_empty() {
                    return Request::Send(line.trim().to_owned());
                }
            }
            KeyCode::Esc => self.line = None,
            KeyCode::Backspace => drop(line.pop()),
            KeyCode::Char(letter) if letter.is_ascii() => line.push(letter),
            _ => {}
        }
        Request::Nothing
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

    fn change_gain(&mut self, factor: f32) -> Request {
        let Gain { name, value, least } = self.gains[self.chosen];
        let value = match value * factor {
            changed if changed >= least => changed,
            _ if factor > 1.0 => least,
            _ => 0.0,
        };
        Request::Send(format!("set {name} {}", three_digits(value)))
    }

    fn toggle(&mut self, channel: Channel) -> Request {
        let all = Channel::ALL.into_iter();
        let wanted = all
            .filter(|other| self.channels.has(*other) != (*other == channel))
            .fold(Channels::NONE, Channels::with);
        if wanted.is_empty() {
            return Request::Nothing;
        }
        self.channels = wanted;
        self.rows.clear();
        self.waiting.clear();
        Request::Stream
    }

    /// Handles the board's answer to a line. If the answer states a gain, the scope adopts its value.
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

    /// Appends new rows of the stream.
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

    /// Shows a capture until a key restarts the stream.
    pub fn show(&mut self, captured: Captured) {
        self.awaits = false;
        self.captured = Some(captured);
    }

    /// Whether a capture is shown.
    pub fn shows_capture(&self) -> bool {
        self.captured.is_some()
    }

    /// Name of the controller's mode.
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

    /// Start and end of the time axis, s.
    pub fn span_s(&self) -> [f64; 2] {
        match &self.captured {
            Some(captured) => {
                let [first, last] = [0, captured.samples.len()].map(|at| captured_s(captured, at));
                [first, last]
            }
            None => [-self.window_s, 0.0],
        }
    }

    /// The plotted traces, in the order of the channels.
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

/// Rounds a gain to three significant digits.
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

    fn typed(scope: &mut Scope, text: &str) -> Request {
        for letter in text.chars() {
            assert_eq!(scope.press(key(KeyCode::Char(letter))), Request::Nothing);
        }
        scope.press(key(KeyCode::Enter))
    }

    #[test]
    fn rows_are_plotted_in_display_units_against_time_before_the_newest_row() {
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
    fn a_gain_changes_by_key_and_takes_the_value_that_the_board_confirms() {
        let mut scope = scope();
        assert_eq!(
            scope.press(key(KeyCode::Up)),
            Request::Send("set pid.kp 0.055".into())
        );
        // The board has not confirmed the new gain yet.
        assert_eq!(scope.gains[0].value, 0.05);
        scope.answered("pid.kp = 0.055 N m/deg at the paddle");
        assert_eq!(scope.gains[0].value, 0.055);
        scope.answered("pid.kp is 0 to 2");
        assert_eq!(
            (scope.gains[0].value, scope.said.as_str()),
            (0.055, "pid.kp is 0 to 2")
        );
        // The integral gain is 0. The first step up sets the smallest value, and the step back sets 0 again.
        scope.press(key(KeyCode::Tab));
        assert_eq!(
            scope.press(key(KeyCode::Up)),
            Request::Send("set pid.ki 0.01".into())
        );
        scope.answered("pid.ki = 0.01 N m/(deg s)");
        assert_eq!(
            scope.press(key(KeyCode::Down)),
            Request::Send("set pid.ki 0".into())
        );
    }

    #[test]
    fn channels_can_be_switched_on_and_off_but_one_always_stays() {
        let mut scope = scope();
        assert_eq!(scope.press(key(KeyCode::Char('4'))), Request::Stream);
        assert_eq!(
            scope.streamed().to_string(),
            "encoder,velocity,torque,mode,fault"
        );
        for digit in ['4', '5'] {
            scope.press(key(KeyCode::Char(digit)));
        }
        assert_eq!(scope.press(key(KeyCode::Char('2'))), Request::Nothing);
        assert_eq!(scope.channels.to_string(), "encoder");
    }

    #[test]
    fn keys_are_letters_while_a_console_line_is_typed() {
        let mut scope = scope();
        scope.press(key(KeyCode::Char(':')));
        assert_eq!(
            typed(&mut scope, "step 10 q"),
            Request::Send("step 10 q".into())
        );
        assert_eq!(scope.line, None);
        scope.press(key(KeyCode::Char(':')));
        scope.press(key(KeyCode::Esc));
        assert_eq!(scope.press(key(KeyCode::Char('q'))), Request::Leave);
    }

    #[test]
    fn ctrl_c_leaves_the_scope_in_every_state() {
        let mut scope = scope();
        scope.press(key(KeyCode::Char(':')));
        let ctrl_c = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(scope.press(ctrl_c), Request::Leave);
    }

    #[test]
    fn a_paused_plot_loses_no_row() {
        let mut scope = scope();
        scope.take(vec![row(0, 0.1)]);
        scope.press(key(KeyCode::Char(' ')));
        scope.take(vec![row(20, 0.2)]);
        assert_eq!(scope.traces()[0].points.len(), 1);
        scope.press(key(KeyCode::Char(' ')));
        assert_eq!(scope.traces()[0].points.len(), 2);
    }

    #[test]
    fn a_capture_is_shown_around_its_trigger_until_the_stream_is_restarted() {
        let mut scope = scope();
        scope.take(vec![row(0, 0.1)]);
        assert_eq!(scope.press(key(KeyCode::Char('c'))), Request::Capture);
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
    fn old_rows_are_discarded() {
        let mut scope = scope();
        for at in 0..100 {
            scope.take(vec![row(at * 20_000, 0.1)]);
        }
        assert!(scope.rows.len() <= 31, "{}", scope.rows.len());
    }
}
