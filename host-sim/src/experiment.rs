//! Experiments on a closed loop, and what they log.

use crate::closed_loop::{ClosedLoop, LoopSetup, Tick};
use crate::sensors::Hall;
use haptic_paddle::controller::{ArmError, Mode, ReferenceError};
use haptic_paddle::excitation::{Excitation, ExcitationError};
use haptic_paddle::safety::Fault;
use haptic_paddle::sensing::encoder;
use haptic_paddle::settings::{FilterOrder, Sensor, Settings};
use haptic_paddle::units::DEG_PER_RAD;
use recording::{Drive, Model, Pid, Recording, Run};

/// One experiment: what to do, for how long, and how often to log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Torque (open loop) or position.
    pub mode: Mode,
    /// Held from the start: N m at the motor, or rad; `None` = where the paddle stands, or no torque.
    pub reference: Option<f32>,
    /// On top of the reference.
    pub excitation: Option<Excitation>,
    /// How long, s.
    pub duration_s: f64,
    /// Rows a second; the nearest whole division of the position loop's rate is taken.
    pub log_hz: f64,
}

impl Experiment {
    /// An excitation of the position loop, logged at every tick of it.
    pub fn position(excitation: Excitation, duration_s: f64) -> Self {
        Self {
            mode: Mode::Position,
            reference: None,
            excitation: Some(excitation),
            duration_s,
            log_hz: f64::INFINITY,
        }
    }

    /// An excitation by torque, logged at every tick of the position loop.
    pub fn torque(excitation: Excitation, duration_s: f64) -> Self {
        Self {
            mode: Mode::Torque,
            ..Self::position(excitation, duration_s)
        }
    }

    /// Carries it out on `closed_loop`, whose paddle and session go on from where they are; the controller is left
    /// disarmed.
    ///
    /// # Errors
    /// [`ExperimentError`] if the duration or the rate is no positive number, or the controller refuses.
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

    /// Time between two rows: a whole number of periods of the position loop.
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

/// Longest experiment, s: at the firmware's rate its trace is some gigabytes.
const LONGEST_S: f64 = 3600.0;

/// Logged times are whole nanoseconds, so that they have as few digits as they deserve.
const TIMES_PER_S: f64 = 1e9;

/// Why an experiment cannot be carried out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// Not a positive, finite time.
    #[error("a duration of {0} s: give more than 0 and at most {LONGEST_S} s")]
    Duration(f64),
    /// Not a positive rate, or less than one row in the whole experiment.
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

/// What an experiment logged; all columns have one length.
///
/// Positions are what each sensor read at the row's instant, unfiltered. The input is the mean of the commanded torque
/// from this row until the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Torque or position.
    pub mode: Mode,
    /// Since the start of the session by the board's clock, s.
    pub time_s: Vec<f64>,
    /// Commanded torque, N m at the motor.
    pub input_nm: Vec<f64>,
    /// True position, rad.
    pub position_rad: Vec<f64>,
    /// By the encoder, rad.
    pub encoder_rad: Vec<f64>,
    /// By the Hall sensor, rad.
    pub hall_rad: Vec<f64>,
    /// As the regulator sees it, filtered, rad.
    pub regulated_rad: Vec<f64>,
    /// In position mode, rad.
    pub setpoint_rad: Vec<f64>,
    /// Measured, A.
    pub current_a: Vec<f32>,
    /// What acts from this row's instant on, share of the supply.
    pub duty: Vec<f32>,
    /// When the controller stopped by itself, s, and why; from then on the paddle was not driven.
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

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// The trace as a run: `position` is the sensor that fed the regulator, the other one is `position_hall` or
    /// `position_encoder`.
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

/// An empty recording of what `setup` runs: horizon in s, the nominal `model`, and its sensors.
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

/// The column of the sensor that does not feed the regulator.
pub fn other_column(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Encoder => "position_hall",
        Sensor::Hall => "position_encoder",
    }
}

/// The encoder, as a recording states it.
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

/// The regulator in the recording's terms, of a position loop of `period`, s; `None` if those cannot state it.
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
