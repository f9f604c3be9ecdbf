//! What the user states about a log.

/// How a log becomes a recording. What the recipe leaves out is guessed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipe {
    /// Column or formula of the time: `NAME`, `NAME:UNIT`, or `FORMULA` in s.
    pub time: Option<String>,
    /// Rows per second of a log without a column of time.
    pub rate_hz: Option<f64>,
    /// Column or formula of the actuator's command.
    pub input: Option<String>,
    /// Column or formula of the position.
    pub position: Option<String>,
    /// Column of the velocity, from which the position is integrated.
    pub velocity: Option<String>,
    /// Column or formula of the setpoint.
    pub setpoint: Option<String>,
    /// Further columns by their names in the recording: `position_hall`, `current`, `supply`, `temperature`.
    pub further: Vec<(String, String)>,
    /// Counts of the position per turn.
    pub counts_per_turn: Option<f64>,
    /// Quantum of the position, in its logged unit.
    pub resolution: Option<f64>,
    /// Standard deviation of the position's noise, in its logged unit.
    pub noise: Option<f64>,
    /// Span at which the position wraps, in its logged unit. 0 = never.
    pub wrap: Option<f64>,
    /// Number of the sign bit in the position's words, from 0.
    pub position_sign_bit: Option<u32>,
    /// Number of the sign bit in the input's words, from 0.
    pub input_sign_bit: Option<u32>,
    /// Number of bits of the input's words in two's complement.
    pub input_bits: Option<u32>,
    /// If true, the input of a row is its value at that instant, not a value held until the next row.
    pub input_is_of_instant: bool,
    /// Period of the device's control loop, s. Formulas are averaged over its ticks.
    pub tick_s: Option<f64>,
    /// Corner frequency of the low-pass in the logged position that is to be undone, Hz.
    pub undo_low_pass_hz: Option<f64>,
    /// The controller whose command is the input, if that was not logged.
    pub pid: Option<PidLaw>,
    /// Part of a run that is kept, s since its start or since the controller was switched on.
    pub keep_s: Option<[f64; 2]>,
    /// A new run starts after a gap of this length, s.
    pub split_gap_s: Option<f64>,
    /// A new run starts where this column changes.
    pub split_by: Option<String>,
    /// If true, the input is that of a controller, whatever else the recipe states.
    pub is_closed_loop: bool,
    /// Length of a prediction window, s.
    pub horizon_s: Option<f64>,
    /// A title, for display.
    pub title: Option<String>,
}

/// A PID law on the logged position. Gains are numbers or formulas of columns, per unit of the logged position.
#[derive(Clone, Debug, PartialEq)]
pub struct PidLaw {
    /// Input per unit of error.
    pub kp: String,
    /// Input per unit of error and per second.
    pub ki: String,
    /// Input per unit of velocity.
    pub kd: String,
    /// The command is limited to ± this.
    pub limit: Option<f64>,
    /// Time of switching on for each log. The last one applies to all further logs. An empty list means always on.
    pub on: Vec<SwitchOn>,
}

/// Time at which a controller was switched on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SwitchOn {
    /// It was always on.
    #[default]
    Always,
    /// This time of the log's clock, s.
    At(f64),
    /// The time at which the first motion fits its command best.
    Found,
}
