//! Experiments on a closed loop and their logs.

use crate::closed_loop::{ClosedLoop, LoopSetup, Tick};
use crate::sensors::Hall;
use haptic_paddle::controller::{ArmError, Mode, ReferenceError};
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::safety::Fault;
use haptic_paddle::sensing::encoder;
use haptic_paddle::settings::{FilterOrder, Sensor, Settings};
use haptic_paddle::units::DEG_PER_RAD;
use recording::{Drive, Model, Pid, Recording, Run};

/// One experiment: its excitation, its duration and its log rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Mode of the controller: torque (open loop) or position.
    pub mode: Mode,
    /// Reference from the start: N m at the motor, or rad. `None` = the present position, or zero torque.
    pub reference: Option<f32>,
    /// Excitation in addition to the reference.
    pub excitation: Option<Excitation>,
    /// Duration, s.
    pub duration_s: f64,
    /// Rows per second. The nearest integer divisor of the position loop's rate is used.
    pub log_hz: f64,
}

impl Experiment {
    /// An excitation of the setpoint, logged at every tick of the position loop.
    pub fn position(excitation: Excitation, duration_s: f64) -> Self {
        Self {
            mode: Mode::Position,
            reference: None,
            excitation: Some(excitation),
            duration_s,
            log_hz: f64::INFINITY,
        }
    }

    /// An excitation of the torque, logged at every tick of the position loop.
    pub fn torque(excitation: Excitation, duration_s: f64) -> Self {
        Self {
            mode: Mode::Torque,
            ..Self::position(excitation, duration_s)
        }
    }

    /// Runs the experiment on `closed_loop`. Its paddle and session continue from their present state. The controller is
    /// disarmed at the end.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`] if the duration or the rate is not a positive number, or if the controller refuses.
    pub fn run(&self, closed_loop: &mut ClosedLoop) -> Result<Trace, ExperimentError> {
        let rates = closed_loop.rates();
        let divider = usize::from(rates.divider.max(1));
        let row_s = self.row_s(rates.position_tick_s())?;
        let ticks_per_row = (row_s / rates.tick_s).round() as usize;
        let rows = (self.duration_s / row_s).round() as usize;
        debug_assert_eq!(ticks_per_row % divider, 0);

        let controller = closed_loop.controller_mut();
        controller.disarm();
        controller.arm(self.mode)?;
        if let Some(reference) = self.reference {
            controller.set_reference(reference)?;
        }
        if let Some(excitation) = &self.excitation {
            controller.start(excitation)?;
        }

        let mut trace = Trace::with_capacity(self.mode, rows);
        for _ in 0..rows {
            let mut told_nm = 0.0;
            for i in 0..ticks_per_row {
                let tick = closed_loop.tick();
                if i == 0 {
                    trace.log(&tick, closed_loop);
                }
                told_nm += f64::from(tick.acting.torque_nm);
            }
            trace.input_nm.push(told_nm / ticks_per_row as f64);
            if let (None, Some(fault)) = (trace.fault, closed_loop.controller().fault()) {
                trace.fault = Some((closed_loop.time_s(), fault));
            }
        }
        closed_loop.controller_mut().disarm();
        Ok(trace)
    }

    /// Time between two rows, s: an integer number of periods of the position loop.
    fn row_s(&self, position_tick_s: f64) -> Result<f64, ExperimentError> {
        if !(self.duration_s > 0.0 && self.duration_s <= LONGEST_S) {
            return Err(ExperimentError::Duration(self.duration_s));
        }
        if self.log_hz.is_nan() || self.log_hz <= 0.0 {
            return Err(ExperimentError::LogRate(self.log_hz));
        }
        let periods = (1.0 / (self.log_hz * position_tick_s)).round().max(1.0);
        let row_s = periods * position_tick_s;
        if row_s <= self.duration_s {
            Ok(row_s)
        } else {
            Err(ExperimentError::LogRate(self.log_hz))
        }
    }
}

/// Longest experiment, s. At the firmware's rate its trace takes some gigabytes.
const LONGEST_S: f64 = 3600.0;

/// Logged times are rounded to nanoseconds, so that they have few digits.
const TIMES_PER_S: f64 = 1e9;

/// Why an experiment cannot be run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The duration is not positive or is too long.
    #[error("a duration of {0} s: give more than 0 and at most {LONGEST_S} s")]
    Duration(f64),
    /// The rate is not positive, or gives less than one row in the whole experiment.
    #[error("a log rate of {0} Hz: give more than 0, and enough for a row within the duration")]
    LogRate(f64),
    /// The controller refuses to arm.
    #[error("{0}")]
    Arm(#[from] ArmError),
    /// The controller refuses the reference.
    #[error("{0}")]
    Reference(#[from] ReferenceError),
    /// The controller refuses the excitation.
    #[error("{0}")]
    Excitation(#[from] ExcitationError),
}

/// The log of an experiment. All columns have the same length.
///
/// Positions are unfiltered sensor readings at the time of the row. The input is the mean of the commanded torque from this
/// row until the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Mode of the controller.
    pub mode: Mode,
    /// Time since the start of the session by the board's clock, s.
    pub time_s: Vec<f64>,
    /// Commanded torque, N m at the motor.
    pub input_nm: Vec<f64>,
    /// True position, rad.
    pub position_rad: Vec<f64>,
    /// Reading of the encoder, rad.
    pub encoder_rad: Vec<f64>,
    /// Reading of the Hall sensor, rad.
    pub hall_rad: Vec<f64>,
    /// Filtered position that the regulator uses, rad.
    pub regulated_rad: Vec<f64>,
    /// Setpoint in position mode, rad.
    pub setpoint_rad: Vec<f64>,
    /// Measured current, A.
    pub current_a: Vec<f32>,
    /// Duty from the time of this row, as a share of the supply.
    pub duty: Vec<f32>,
    /// Time, s, and cause of a stop by the controller. The paddle was not driven after it.
    pub fault: Option<(f64, Fault)>,
}

impl Trace {
    fn with_capacity(mode: Mode, rows: usize) -> Self {
        let column = || Vec::with_capacity(rows);
        Self {
            mode,
            time_s: column(),
            input_nm: column(),
            position_rad: column(),
            encoder_rad: column(),
            hall_rad: column(),
            regulated_rad: column(),
            setpoint_rad: column(),
            current_a: Vec::with_capacity(rows),
            duty: Vec::with_capacity(rows),
            fault: None,
        }
    }

    fn log(&mut self, tick: &Tick, closed_loop: &ClosedLoop) {
        let controller = closed_loop.controller();
        self.time_s
            .push((tick.time_s * TIMES_PER_S).round() / TIMES_PER_S);
        self.position_rad.push(tick.position_rad);
        self.encoder_rad.push(f64::from(controller.encoder_rad()));
        self.hall_rad.push(f64::from(controller.hall_rad()));
        self.regulated_rad
            .push(f64::from(controller.position_rad()));
        self.setpoint_rad.push(f64::from(controller.setpoint_rad()));
        self.current_a.push(controller.current_a());
        self.duty.push(tick.acting.duty.0);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Converts the trace to a run of a recording. `position` is the sensor that fed the regulator. The other one is
    /// `position_hall` or `position_encoder`.
    pub fn to_run(&self, file: impl Into<String>, setup: &LoopSetup) -> Run {
        let closed = self.mode == Mode::Position;
        let settings = &setup.settings;
        let (position, other) = match settings.estimate.sensor {
            Sensor::Encoder => (&self.encoder_rad, &self.hall_rad),
            Sensor::Hall => (&self.hall_rad, &self.encoder_rad),
        };
        let drive = if closed {
            Drive::ClosedLoop
        } else {
            Drive::OpenLoop
        };
        let mut run = Run::new(
            file,
            drive,
            self.time_s.clone(),
            self.input_nm.clone(),
            position.clone(),
        );
        run.positions
            .insert(other_column(settings.estimate.sensor).into(), other.clone());
        run.current = Some(self.current_a.clone());
        if closed {
            run.setpoint = Some(self.setpoint_rad.clone());
            run.controller = pid(settings, setup.rates.position_tick_s());
        }
        run
    }
}

/// An empty recording for `setup`, with the horizon in s, the nominal `model`, and the sensors.
pub fn recording(
    title: impl Into<String>,
    horizon: f64,
    model: Model,
    setup: &LoopSetup,
) -> Recording {
    let settings = &setup.settings;
    let encoder = encoder_sensor(settings);
    let hall = hall_sensor(&setup.paddle.hall);
    let (position, other) = match settings.estimate.sensor {
        Sensor::Encoder => (encoder, hall),
        Sensor::Hall => (hall, encoder),
    };
    let mut recording = Recording::new(title, horizon, model);
    recording.sensors.insert("position".into(), position);
    recording
        .sensors
        .insert(other_column(settings.estimate.sensor).into(), other);
    recording
}

/// Column name of the sensor that does not feed the regulator.
pub fn other_column(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Encoder => "position_hall",
        Sensor::Hall => "position_encoder",
    }
}

/// The encoder as described in a recording.
pub fn encoder_sensor(settings: &Settings) -> recording::Sensor {
    let mechanism = &settings.mechanism;
    recording::Sensor {
        resolution: f64::from(encoder::rad_per_count(
            mechanism.counts_per_turn,
            mechanism.ratio,
        )),
        ..recording::Sensor::default()
    }
}

fn hall_sensor(hall: &Hall) -> recording::Sensor {
    recording::Sensor {
        resolution: hall.resolution_rad(),
        noise: hall.noise_rad(),
        cutoff_hz: None,
    }
}

/// The regulator as described in a recording, for a position loop with this `period`, s. `None` if the format cannot
/// describe it.
pub fn pid(settings: &Settings, period: f64) -> Option<Pid> {
    let (gains, estimate, on) = (&settings.pid, &settings.estimate, &settings.compensation);
    let stated = gains.setpoint_weight == 1.0
        && gains.derivative_cutoff_hz == 0.0
        && (estimate.order == FilterOrder::First || estimate.cutoff_hz == 0.0)
        && !(on.dry || on.viscous || on.gravity);
    let per_rad_at_motor = f64::from(DEG_PER_RAD) / f64::from(settings.mechanism.ratio);
    stated.then(|| Pid {
        kp: f64::from(gains.kp_nm_per_deg) * per_rad_at_motor,
        ki: f64::from(gains.ki_nm_per_deg_s) * per_rad_at_motor,
        kd: f64::from(gains.kd_nm_s_per_deg) * per_rad_at_motor,
        period,
        position_cutoff_hz: (estimate.cutoff_hz > 0.0).then_some(f64::from(estimate.cutoff_hz)),
    })
}
