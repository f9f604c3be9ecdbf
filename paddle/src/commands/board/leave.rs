//! Output files of a board run: a trace of the firmware's measurements, and a recording of the true motion of the paddle.

use crate::failure::Failure;
use crate::files::{self, csv};
use host_sim::closed_loop::LoopSetup;
use host_sim::experiment;
use recording::{Drive, Model, Recording, Run, Sensor};
use virtual_board::board::{Board, Step};
use virtual_board::log::Entry;
use virtual_board::wiring::STEP_S;

/// Data collected from the board while it runs.
pub struct Session {
    /// Number of control periods per row.
    steps_per_row: usize,
    rows: Vec<Row>,
    /// Number of periods, and sum of their torques, in the row that is not complete yet.
    begun: (usize, f64),
    /// Bytes that the firmware sent to its terminal.
    console: Vec<u8>,
    /// Entries that the firmware logged.
    pub log: Vec<Entry>,
}

/// Mean over a number of consecutive control periods.
struct Row {
    /// The last period of the row.
    last: Step,
    /// Mean motor torque over the periods of the row, N m.
    torque_nm: f64,
}

impl Session {
    /// Creates an empty session that stores `log_hz` rows per second.
    ///
    /// # Errors
    /// Returns [`Failure::Board`] if `log_hz` exceeds the control rate.
    pub fn new(log_hz: f64) -> Result<Self, Failure> {
        if log_hz * STEP_S > 1.0 + ROUNDING {
            let most = 1.0 / STEP_S;
            return Err(Failure::Board(format!(
                "--log-rate {log_hz}: the control period gives {most:.0} rows a second at most"
            )));
        }
        Ok(Self {
            steps_per_row: (1.0 / (log_hz * STEP_S)).round().max(1.0) as usize,
            rows: Vec::new(),
            begun: (0, 0.0),
            console: Vec::new(),
            log: Vec::new(),
        })
    }

    /// Collects the data that `board` produced since the last call. Returns the new terminal bytes and the new log entries.
    pub fn take(&mut self, board: &mut Board) -> (Vec<u8>, Vec<Entry>) {
        for step in board.take_steps() {
            let (periods, sum_nm) = (self.begun.0 + 1, self.begun.1 + step.torque_nm);
            self.begun = (periods, sum_nm);
            if periods == self.steps_per_row {
                let torque_nm = sum_nm / periods as f64;
                self.rows.push(Row {
                    last: step,
                    torque_nm,
                });
                self.begun = (0, 0.0);
            }
        }
        let (said, logged) = (board.terminal.take_answer(), board.take_log());
        self.console.extend(&said);
        self.log.extend(logged.iter().cloned());
        (said, logged)
    }

    /// The text that the firmware sent to its terminal.
    pub fn console(&self) -> String {
        String::from_utf8_lossy(&self.console).replace("\r\n", "\n")
    }

    /// The quantities that the firmware measured and commanded, as CSV.
    pub fn trace(&self) -> String {
        let column = |value: fn(&Step) -> f64| -> Vec<f64> {
            self.rows.iter().map(|row| value(&row.last)).collect()
        };
        csv(&[
            ("time", &column(|step| step.time_s)),
            (
                "encoder",
                &column(|step| f64::from(step.encoder_count as i32)),
            ),
            ("hall", &column(|step| f64::from(step.hall_counts))),
            (
                "current",
                &column(|step| {
                    f64::from(step.current.sum) / f64::from(step.current.conversions.max(1))
                }),
            ),
            ("compare", &column(|step| f64::from(step.compare))),
            (
                "on",
                &column(|step| f64::from(u8::from(step.duty.is_some()))),
            ),
            ("duty", &column(|step| step.duty.unwrap_or(0.0))),
        ])
    }

    /// A recording with the true position as output and the true motor torque as input.
    pub fn recording(&self, horizon: f64, model: Model, setup: &LoopSetup) -> Recording {
        let mut run = Run::new("board.csv", Drive::ClosedLoop, vec![], vec![], vec![]);
        let mut currents = Vec::new();
        let constant = f64::from(setup.settings.motor.torque_constant_nm_per_a);
        // The input of a row acts until the next row, so it is the torque averaged over the steps that follow.
        for pair in self.rows.windows(2) {
            let at = &pair[0].last;
            run.time.push(files::logged(at.time_s));
            run.position.push(files::logged(at.position_rad));
            run.input.push(files::logged(pair[1].torque_nm));
            currents.push((at.torque_nm / constant) as f32);
        }
        run.current = Some(currents);
        let mut recording = experiment::recording("The virtual board", horizon, model, setup);
        recording.sensors.clear();
        recording
            .sensors
            .insert("position".into(), Sensor::default());
        recording.runs.push(run);
        recording
    }
}

/// Relative rounding error that is allowed in a rate typed on the command line.
const ROUNDING: f64 = 1e-6;

/// Formats a log entry as a line of text.
pub fn log_line(entry: &Entry) -> String {
    format!(
        "log {:.4} s {} {}",
        entry.time_s, entry.level, entry.message
    )
}
