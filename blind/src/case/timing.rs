//! Timing errors of a log. The input column is shifted against the position column. The input is sampled at an instant
//! instead of averaged over the row. Logged times differ from the true sampling times.

use recording::Recording;

use crate::draw::Draw;
use crate::session::{Log, round_input};

/// Largest shift of the input column against the position column, in rows.
const MOST_OFFSET_ROWS: f64 = 0.5;
/// Least and largest standard deviation of the errors of logged times, in rows.
const STAMP_STD_ROWS: [f64; 2] = [0.005, 0.1];
/// Largest error of a logged time, in standard deviations.
const MOST_DEVIATIONS: f64 = 3.0;
/// Least difference of two successive logged times, over the true difference.
const LEAST_PERIOD: f64 = 0.1;

/// Probability that the manifest states an uncertainty of the shift.
const STATED: f64 = 0.3;
/// Least and largest true shift over the stated uncertainty.
const TRUE_OVER_STATED: [f64; 2] = [0.5, 2.0];
/// Least uncertainty that is stated, in rows.
const LEAST_STATED_ROWS: f64 = 0.05;

/// The timing errors of a log.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrongTimes {
    pub offset_rows: f64,
    pub point_sampled: bool,
    pub stamp_std_rows: f64,
    /// Standard deviation of the shift that the manifest states, in rows. 0 if it states none.
    pub stated_std_rows: f64,
}

impl WrongTimes {
    pub const NONE: Self = Self {
        offset_rows: 0.0,
        point_sampled: false,
        stamp_std_rows: 0.0,
        stated_std_rows: 0.0,
    };

    pub fn draw(draw: &mut Draw) -> Self {
        Self {
            offset_rows: draw.uniform(-MOST_OFFSET_ROWS, MOST_OFFSET_ROWS),
            point_sampled: draw.chance(0.5),
            stamp_std_rows: draw.log_uniform(STAMP_STD_ROWS[0], STAMP_STD_ROWS[1]),
            stated_std_rows: 0.0,
        }
    }

    /// Adds the stated uncertainty, which some manifests have and others have not.
    pub fn stated(self, draw: &mut Draw) -> Self {
        let over = draw.log_uniform(TRUE_OVER_STATED[0], TRUE_OVER_STATED[1]);
        let states = draw.chance(STATED);
        let distance_rows = (self.apparent_delay_rows().abs() / over).max(LEAST_STATED_ROWS);
        Self {
            stated_std_rows: if states { distance_rows } else { 0.0 },
            ..self
        }
    }

    /// Writes the stated uncertainty into the manifest. `row_s` is the period of the rows, s.
    pub fn state(self, recording: &mut Recording, row_s: f64) {
        let std_s = (self.stated_std_rows * row_s * 1e7).round() / 1e7;
        for run in &mut recording.runs {
            run.input_time_std = std_s;
        }
    }

    /// Halves the errors. Once they are small, the input is averaged instead of sampled.
    pub fn milder(self) -> Self {
        if self.offset_rows.abs() < 0.02 && self.stamp_std_rows < STAMP_STD_ROWS[0] {
            return Self {
                point_sampled: false,
                ..self
            };
        }
        Self {
            offset_rows: 0.5 * self.offset_rows,
            stamp_std_rows: 0.5 * self.stamp_std_rows,
            ..self
        }
    }

    /// Apparent delay of the device in rows. No data can separate it from a true delay.
    pub fn apparent_delay_rows(self) -> f64 {
        self.offset_rows - if self.point_sampled { 0.5 } else { 0.0 }
    }

    /// The logs with these timing errors.
    pub fn apply_all(self, logs: &[Log], draw: &mut Draw) -> Vec<Log> {
        logs.iter().map(|log| self.apply(log, draw)).collect()
    }

    fn apply(self, log: &Log, draw: &mut Draw) -> Log {
        let n = log.time_s.len();
        let end_of = |row: usize| log.time_s.get(row + 1).copied().unwrap_or(log.end_s);
        let usual_s = (log.end_s - log.time_s[0]) / n as f64;
        let offset_s = self.offset_rows * usual_s;
        let mut written = log.clone();
        for row in 0..n {
            let [from_s, to_s] = [log.time_s[row], end_of(row)].map(|time_s| time_s + offset_s);
            written.input[row] = if self.point_sampled {
                log.commanded.value_at(from_s)
            } else {
                log.commanded.mean(from_s, to_s)
            };
            if row > 0 {
                let error_s = self.stamp_std_rows * usual_s * draw.normal_within(MOST_DEVIATIONS);
                let period_s = log.time_s[row] - log.time_s[row - 1];
                let least_s = written.time_s[row - 1] + LEAST_PERIOD * period_s;
                written.time_s[row] = (log.time_s[row] + error_s).max(least_s);
            }
        }
        written.end_s = log
            .end_s
            .max(written.time_s[n - 1] + LEAST_PERIOD * usual_s);
        round_input(&mut written.input);
        written
    }
}
