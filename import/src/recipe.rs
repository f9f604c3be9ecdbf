//! What the user says of a log, in whole or in part.

/// How a log becomes a recording. What the recipe leaves out is guessed from the log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipe {
    /// Column or formula of time: `NAME`, `NAME:UNIT`, `FORMULA` in s.
    pub time: Option<String>,
    /// Rows per second of a log without a column of time.
    pub rate_hz: Option<f64>,
    /// Column or formula of the actuator's command.
    pub input: Option<String>,
    /// Column or formula of position.
    pub position: Option<String>,
    /// Column of velocity, of which the position is made as the integral.
    pub velocity: Option<String>,
    /// Column or formula of the position that was asked for.
    pub setpoint: Option<String>,
    /// Further columns by the recording's names: `position_hall`, `current`, `supply`, `temperature`.
    pub further: Vec<(String, String)>,
    /// Counts of the position in one turn.
    pub counts_per_turn: Option<f64>,
    /// Quantum of the position, in its logged unit.
    pub resolution: Option<f64>,
    /// Standard deviation of the position's noise, in its logged unit.
    pub noise: Option<f64>,
    /// Span around which the position wraps, in its logged unit; 0 for never.
    pub wrap: Option<f64>,
    /// Bit, from 0, that is the sign of the position's words.
    pub position_sign_bit: Option<u32>,
    /// Bit, from 0, that is the sign of the input's words.
    pub input_sign_bit: Option<u32>,
    /// Bits of the input's words in two's complement.
    pub input_bits: Option<u32>,
    /// The value of a row's input is that of its instant, not the one that is held until the next.
    pub input_is_of_instant: bool,
    /// Period of the device's own loop, s: formulas are averaged over its ticks.
    pub tick_s: Option<f64>,
    /// Corner of the low-pass that the device applied to the logged position, to be undone, Hz.
    pub undo_low_pass_hz: Option<f64>,
    /// The controller whose command is the input, where that was not logged.
    pub pid: Option<PidLaw>,
    /// Part of a run that is kept, s from its begin, or from the controller's.
    pub keep_s: Option<[f64; 2]>,
    /// A new run begins after a gap of so much, s.
    pub split_gap_s: Option<f64>,
    /// A new run begins where this column changes.
    pub split_by: Option<String>,
    /// The input is a controller's, whatever else the recipe says.
    pub is_closed_loop: bool,
    /// Length of a prediction window, s.
    pub horizon_s: Option<f64>,
    /// A line for people.
    pub title: Option<String>,
}

/// A PID law on the logged position: gains as numbers or formulas of columns, per unit of the position as logged.
#[derive(Clone, Debug, PartialEq)]
pub struct PidLaw {
    /// Input per unit of error.
    pub kp: String,
    /// Input per unit of error and second.
    pub ki: String,
    /// Input per unit of position and per second.
    pub kd: String,
    /// The command is clipped at ± this.
    pub limit: Option<f64>,
    /// When it was switched on, log by log; the last one holds for all that follow, and none means always.
    pub on: Vec<SwitchOn>,
}

/// When a controller was switched on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SwitchOn {
    /// It always was.
    #[default]
    Always,
    /// At this time of the log's own clock, s.
    At(f64),
    /// Where the first motion follows its command best.
    Found,
}
