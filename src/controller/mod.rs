//! The controller. One call of `step` turns a measurement into a duty.

mod refusal;
mod tuning;

pub use refusal::{ArmError, ReferenceError, ZeroError};
pub use tuning::{TickRate, Tuning};

use crate::control::compensation::Compensation;
use crate::control::current::CurrentLoop;
use crate::control::position::Pid;
use crate::estimate::biquad::SecondOrder;
use crate::estimate::velocity::VelocityObserver;
use crate::excitation::{Excitation, ExcitationError, Generator, Shape};
use crate::metrics::{StepMetrics, StepReport};
use crate::safety::{Acted, Counters, Fault, FaultLog, FaultRecord, Limits, Monitor};
use crate::scalar::limit;
use crate::sensing::current::{self, CurrentSensor, IdleReading, OffsetError};
use crate::sensing::encoder::Encoder;
use crate::sensing::hall::{self, HallCurve};
use crate::settings::{Sensor, Settings};
use crate::telemetry::Sample;

/// Measurements of one control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Count of the encoder. It wraps.
    pub encoder_count: u32,
    /// Result of the Hall converter, 12 bit.
    pub hall_adc: u16,
    /// Result of the current converter in counts, mean over the period.
    pub current_adc: f32,
}

/// Duty of the bridge, -0.95 to 0.95 of the supply. A positive duty turns the paddle in the positive direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Duty(pub f32);

impl Duty {
    /// Zero voltage.
    pub const ZERO: Self = Self(0.0);

    /// Compare value that produces this duty, for a timer that counts from 0 to `top` and back. Half of `top` is zero
    /// voltage.
    #[inline]
    pub fn compare(self, top: u16) -> u16 {
        const ROUND: f32 = 0.5;
        let half = 0.5 * f32::from(top);
        // The conversion goes through `u32`, which the FPU supports directly.
        (half + half * self.0 + ROUND) as u32 as u16
    }

    /// The duty that results from the rounding of [`Self::compare`].
    pub fn stepped(self, top: u16) -> Self {
        let half = 0.5 * f32::from(top);
        Self((f32::from(self.compare(top)) - half) / half)
    }
}

/// Operating mode of the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Off: the duty is 0.
    #[default]
    Off,
    /// The bridge is on at zero voltage, which brakes. The offset of the current is measured.
    Idle,
    /// Open loop. The reference is a torque, N m at the motor.
    Torque,
    /// Position control. The reference is an angle, rad at the paddle.
    Position,
}

/// Source of an immediate stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCause {
    /// Ctrl-C on the serial port.
    Typed,
    /// The button on the board.
    Button,
}

/// State of the controller at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// Operating mode.
    pub mode: Mode,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// Whether the zero of the encoder is set.
    pub zeroed: bool,
    /// Filtered position that the regulator uses, rad.
    pub position_rad: f32,
    /// Unfiltered position of the Hall sensor, rad.
    pub hall_rad: f32,
    /// Velocity of the paddle, rad/s.
    pub velocity_rad_s: f32,
    /// Setpoint in position mode, rad.
    pub setpoint_rad: f32,
    /// Commanded torque, N m at the motor.
    pub torque_nm: f32,
    /// Motor current, A.
    pub current_a: f32,
    /// Metrics of the last step response.
    pub metrics: Option<StepReport>,
    /// Value of the last ramp at which the paddle started to move, in the unit of the mode.
    pub breakaway: Option<f32>,
}

/// The control core.
#[derive(Clone, Debug)]
pub struct Controller {
    rate: TickRate,
    position_tick_s: f32,
    position_rate_hz: f32,
    ticks_to_position: u16,

    sensor: Sensor,
    encoder: Encoder,
    hall: HallCurve,
    current_sensor: CurrentSensor,
    filter: SecondOrder,
    velocity: VelocityObserver,
    acceleration_per_nm: f32,
    compensation: Compensation,
    pid: Pid,
    current_loop: CurrentLoop,
    limits: Limits,
    torque_limit_nm: f32,
    band_rad: f32,

    mode: Mode,
    /// Number of position ticks since boot.
    ticks: u32,
    fault: Option<Fault>,
    faults: FaultLog,
    counters: Counters,
    stopped: Option<StopCause>,
    bridge_ready: bool,
    monitor: Monitor,
    idle: IdleReading,
    duty: f32,
    zeroed: bool,
    primed: bool,
    seen: Option<Measurement>,
    disagreed_ticks: u32,

    reference: f32,
    generator: Option<Generator>,
    /// Contribution of the excitation to the setpoint at the next position tick.
    excitation: f32,
    /// True if [`Self::look_ahead`] has not been called since the last position tick.
    behind: bool,
    metrics: Option<StepMetrics>,
    breakaway: Option<f32>,

    encoder_rad: f32,
    hall_rad: f32,
    position_rad: f32,
    setpoint: f32,
    torque_nm: f32,
    current_a: f32,
}

impl Controller {
    /// A disarmed controller with these settings and this rate.
    pub fn new(settings: &Settings, rate: TickRate) -> Self {
        let tuning = Tuning::new(settings, rate);
        Self {
            rate,
            position_tick_s: rate.position_tick_s(),
            position_rate_hz: 1.0 / rate.position_tick_s(),
            ticks_to_position: 0,
            sensor: tuning.sensor,
            encoder: Encoder::new(settings.mechanism.counts_per_turn, settings.mechanism.ratio),
            hall: tuning.hall,
            current_sensor: CurrentSensor::default(),
            filter: SecondOrder::new(tuning.filter),
            velocity: VelocityObserver::new(tuning.velocity),
            acceleration_per_nm: tuning.acceleration_per_nm,
            compensation: tuning.compensation,
            pid: Pid::new(tuning.pid),
            current_loop: CurrentLoop::new(tuning.current),
            limits: tuning.limits,
            torque_limit_nm: tuning.torque_limit_nm,
            band_rad: tuning.band_rad,
            mode: Mode::Off,
            ticks: 0,
            fault: None,
            faults: FaultLog::default(),
            counters: Counters::default(),
            stopped: None,
            bridge_ready: true,
            monitor: Monitor::new(tuning.monitor),
            idle: IdleReading::default(),
            duty: 0.0,
            zeroed: false,
            primed: false,
            seen: None,
            disagreed_ticks: 0,
            reference: 0.0,
            generator: None,
            excitation: 0.0,
            behind: false,
            metrics: None,
            breakaway: None,
            encoder_rad: 0.0,
            hall_rad: 0.0,
            position_rad: 0.0,
            setpoint: 0.0,
            torque_nm: 0.0,
            current_a: 0.0,
        }
    }

    /// Computes one control period. The control interrupt calls only this function.
    #[inline]
    pub fn step(&mut self, measurement: &Measurement) -> Duty {
        if !current::plausible(measurement.current_adc)
            && !self.accepts_current_reading(measurement.current_adc)
        {
            return Duty::ZERO;
        }
        self.current_a = self.current_sensor.amperes(measurement.current_adc);

        if self.ticks_to_position == 0 {
            self.ticks_to_position = self.rate.divider;
            self.position_step(measurement);
        }
        self.ticks_to_position -= 1;
        if self.ticks_to_position == 0 {
            self.look_ahead();
            self.watch(measurement);
        }

        match self.mode {
            Mode::Off => return Duty::ZERO,
            Mode::Idle => {
                self.idle.add(measurement.current_adc);
                return Duty::ZERO;
            }
            Mode::Torque | Mode::Position => {}
        }
        if self.limits.overcurrent(self.current_a) {
            self.report_fault(Fault::Overcurrent);
            return Duty::ZERO;
        }
        let duty = self.current_loop.update(
            self.torque_nm,
            self.current_a,
            self.velocity.velocity_rad_s(),
        );
        if !duty.is_finite() {
            self.report_fault(Fault::NonFinite);
            return Duty::ZERO;
        }
        self.duty = duty;
        Duty(duty)
    }

    /// Returns true if control continues although the current reading is at an end of its range. It continues only if
    /// disarmed and if the reading is a finite number.
    #[cold]
    #[inline(never)]
    fn accepts_current_reading(&mut self, mean_counts: f32) -> bool {
        if !mean_counts.is_finite() {
            self.report_fault(Fault::NonFinite);
            return false;
        }
        if self.mode != Mode::Off {
            self.report_fault(Fault::CurrentSignal);
        }
        self.mode == Mode::Off
    }

    /// Passes the duty and the current to the monitor, whose windows are one millisecond long.
    #[inline]
    fn watch(&mut self, measurement: &Measurement) {
        if self.mode == Mode::Off {
            self.monitor.cool();
            return;
        }
        if self.monitor.add(self.duty, self.current_a) {
            let judged = self.monitor.judge(
                self.torque_nm,
                self.encoder_rad,
                self.hall_rad,
                hall::plausible(measurement.hall_adc),
            );
            if let Some(fault) = judged {
                self.report_fault(fault);
            }
        }
    }

    /// Sensing, estimation and torque. It runs once per position tick.
    #[inline]
    fn position_step(&mut self, measurement: &Measurement) {
        self.ticks = self.ticks.wrapping_add(1);
        self.seen = Some(*measurement);
        self.encoder_rad = self.encoder.position_rad(measurement.encoder_count);
        self.hall_rad = self.hall.position_rad(measurement.hall_adc);
        if !self.primed {
            self.prime();
        }
        let measured_rad = self.measured_rad();
        self.position_rad = self.filter.update(measured_rad);
        let velocity_rad_s = self
            .velocity
            .update(measured_rad, self.torque_nm * self.acceleration_per_nm);

        if self.mode == Mode::Off {
            return;
        }
        if let Some(fault) = self.motion_fault(measurement, measured_rad, velocity_rad_s) {
            self.report_fault(fault);
            return;
        }
        if self.mode == Mode::Idle {
            return;
        }
        let previous_setpoint = self.setpoint;
        self.setpoint = self.reference + self.excitation;
        self.behind = true;
        let closed = self.mode == Mode::Position;
        let setpoint_velocity = if closed {
            (self.setpoint - previous_setpoint) * self.position_rate_hz
        } else {
            0.0
        };
        let compensation_nm =
            self.compensation
                .torque_nm(self.position_rad, velocity_rad_s, setpoint_velocity);
        let torque_nm = if closed {
            self.pid.update(
                self.setpoint,
                self.position_rad,
                velocity_rad_s,
                compensation_nm,
            )
        } else {
            limit(self.setpoint + compensation_nm, self.torque_limit_nm)
        };
        if !torque_nm.is_finite() {
            self.report_fault(Fault::NonFinite);
            return;
        }
        self.torque_nm = torque_nm;
    }

    /// Angle of the sensor that feeds the regulator, rad.
    #[inline]
    fn measured_rad(&self) -> f32 {
        match self.sensor {
            Sensor::Encoder => self.encoder_rad,
            Sensor::Hall => self.hall_rad,
        }
    }

    /// Updates what the torque does not depend on: the metrics of the last position tick and the excitation of the next one.
    /// It runs in the tick before the position tick, so that the load is distributed.
    #[inline(never)]
    fn look_ahead(&mut self) {
        if !core::mem::take(&mut self.behind) {
            return;
        }
        if self.mode == Mode::Position
            && let Some(metrics) = &mut self.metrics
        {
            metrics.update(self.position_rad);
        }
        self.excite();
    }

    /// Takes the next value of the excitation, and stops the excitation after the last value.
    #[inline]
    fn excite(&mut self) {
        let Some(generator) = &mut self.generator else {
            return;
        };
        match generator.next(self.position_rad) {
            Some(value) => self.excitation = value,
            None => {
                self.breakaway = generator.breakaway();
                self.stop();
            }
        }
    }

    #[inline]
    fn motion_fault(
        &mut self,
        measurement: &Measurement,
        measured_rad: f32,
        velocity_rad_s: f32,
    ) -> Option<Fault> {
        // A non-finite measurement makes the velocity non-finite.
        if !velocity_rad_s.is_finite() {
            self.primed = false;
            return Some(Fault::NonFinite);
        }
        if !hall::plausible(measurement.hall_adc) && (self.sensor == Sensor::Hall || !self.zeroed) {
            return Some(Fault::HallSignal);
        }
        // Without a zero, the encoder does not give the absolute position.
        let (position_rad, disagreement_rad) = if self.zeroed {
            (measured_rad, self.encoder_rad - self.hall_rad)
        } else {
            (self.hall_rad, 0.0)
        };
        self.limits.motion_fault(
            position_rad,
            velocity_rad_s,
            disagreement_rad,
            &mut self.disagreed_ticks,
        )
    }

    /// Resets the estimators to rest at the measured angle. It is used at the start, after a zero, and at a change of the
    /// sensor.
    #[cold]
    #[inline(never)]
    fn prime(&mut self) {
        let measured_rad = self.measured_rad();
        self.primed = true;
        self.filter.reset(measured_rad);
        self.velocity.reset(measured_rad);
        self.position_rad = measured_rad;
        self.pid.rebase(measured_rad);
    }

    /// Starts control. In position mode the reference is the present position, in torque mode it is 0.
    ///
    /// # Errors
    ///
    /// [`ArmError`] if a fault is latched, the bridge reports a fault, nothing was measured yet, the controller is armed
    /// already, or the encoder has no zero in position mode.
    pub fn arm(&mut self, mode: Mode) -> Result<(), ArmError> {
        if let Some(fault) = self.fault {
            return Err(ArmError::Faulted(fault));
        }
        if mode == Mode::Off {
            self.disarm();
            return Ok(());
        }
        if !matches!(self.mode, Mode::Off | Mode::Idle) {
            return Err(ArmError::AlreadyArmed);
        }
        if !self.bridge_ready {
            return Err(ArmError::BridgeNotReady);
        }
        if self.seen.is_none() {
            return Err(ArmError::NothingMeasured);
        }
        if mode == Mode::Position && !self.zeroed {
            return Err(ArmError::NotZeroed);
        }
        self.reference = if mode == Mode::Position {
            self.position_rad
        } else {
            0.0
        };
        self.setpoint = self.reference;
        self.disagreed_ticks = 0;
        self.pid.reset(self.position_rad);
        self.current_loop.reset();
        self.monitor.restart(self.encoder_rad, self.hall_rad);
        self.idle = IdleReading::default();
        self.duty = 0.0;
        self.torque_nm = 0.0;
        self.mode = mode;
        Ok(())
    }

    /// Turns the bridge on at zero voltage before `mode` is armed.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::arm`] with that mode.
    pub fn prepare(&mut self, mode: Mode) -> Result<(), ArmError> {
        if mode == Mode::Position && !self.zeroed && self.fault.is_none() {
            return Err(ArmError::NotZeroed);
        }
        self.arm(Mode::Idle)
    }

    /// Arms torque mode for the wiring check.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::arm`].
    pub fn arm_for_check(&mut self) -> Result<(), ArmError> {
        self.arm(Mode::Torque)?;
        self.monitor.ignore_encoder();
        Ok(())
    }

    /// Restarts the measurement of the current offset.
    pub fn restart_idle(&mut self) {
        self.idle = IdleReading::default();
    }

    /// The present measurement of the current offset.
    pub fn idle(&self) -> &IdleReading {
        &self.idle
    }

    /// Takes the measured mean as the offset of the current.
    ///
    /// # Errors
    ///
    /// [`OffsetError`] if the measurement cannot be that of an idle bridge.
    pub fn take_offset(&mut self) -> Result<(), OffsetError> {
        self.current_sensor.calibrate(&self.idle)
    }

    /// Stops at once on request, like [`Self::disarm`], and stores the source of the request.
    #[cold]
    #[inline(never)]
    pub fn stop_at_once(&mut self, cause: StopCause) {
        if self.mode != Mode::Off {
            self.stopped = Some(cause);
        }
        self.disarm();
    }

    /// Takes the source of the last immediate stop.
    pub fn take_stopped(&mut self) -> Option<StopCause> {
        self.stopped.take()
    }

    /// Sets whether the bridge reports no fault. A fault of the bridge is latched only while armed. While disarmed it is a
    /// state, for example without the motor supply.
    #[inline]
    pub fn set_bridge_ready(&mut self, ready: bool) {
        self.bridge_ready = ready;
        if !ready && self.mode != Mode::Off {
            self.report_fault(Fault::Bridge);
        }
    }

    /// Returns true if the bridge reports no fault.
    pub fn bridge_ready(&self) -> bool {
        self.bridge_ready
    }

    /// Counts that a limit acted.
    pub fn count(&mut self, acted: Acted) {
        self.counters.count(acted);
    }

    /// Number of times that each limit acted.
    pub fn counters(&self) -> Counters {
        let (torque, duty) = self.monitor.limited();
        self.counters
            .with(Acted::TorqueLimit, torque)
            .with(Acted::DutyLimit, duty)
    }

    /// Restores the faults from before the reset.
    pub fn recall(&mut self, faults: FaultLog) {
        self.faults = faults;
        self.faults.clear();
    }

    /// The last faults, oldest first.
    pub fn faults(&self) -> &FaultLog {
        &self.faults
    }

    /// Winding resistance, ohm, estimated from voltage and current since arming.
    pub fn resistance_ohm(&self) -> Option<f32> {
        self.monitor.resistance_ohm()
    }

    /// Disarms. The duty is 0 from the next step.
    pub fn disarm(&mut self) {
        self.mode = Mode::Off;
        self.stop();
        self.reference = 0.0;
        self.torque_nm = 0.0;
        self.duty = 0.0;
    }

    /// Stops because of a fault. The fault stays latched until [`Self::clear_fault`]. The first fault is kept.
    #[cold]
    #[inline(never)]
    pub fn report_fault(&mut self, fault: Fault) {
        self.fault.get_or_insert(fault);
        self.faults.push(FaultRecord {
            fault,
            before_reset: false,
            time_s: self.ticks as f32 * self.position_tick_s,
            encoder_rad: self.encoder_rad,
            hall_rad: self.hall_rad,
            velocity_rad_s: self.velocity.velocity_rad_s(),
            torque_nm: self.torque_nm,
            current_a: self.current_a,
            duty: self.duty,
        });
        self.disarm();
    }

    /// Clears the latched fault. The controller stays disarmed.
    pub fn clear_fault(&mut self) {
        self.fault = None;
        self.faults.clear();
    }

    /// Sets the zero of the encoder: the paddle now stands at `angle_rad`.
    ///
    /// # Errors
    ///
    /// [`ZeroError`] while armed, before anything was measured, or if the angle is not a number within the travel.
    pub fn zero_at(&mut self, angle_rad: f32) -> Result<(), ZeroError> {
        if self.mode != Mode::Off {
            return Err(ZeroError::Armed);
        }
        let Some(seen) = self.seen else {
            return Err(ZeroError::NothingMeasured);
        };
        if angle_rad.is_nan() || angle_rad.abs() > self.limits.travel_rad() {
            return Err(ZeroError::OutsideTravel);
        }
        self.encoder.zero(seen.encoder_count, angle_rad);
        self.encoder_rad = angle_rad;
        self.zeroed = true;
        self.primed = false;
        if self.sensor == Sensor::Encoder {
            self.position_rad = angle_rad;
        }
        Ok(())
    }

    /// Sets the zero of the encoder from the calibrated Hall sensor.
    ///
    /// # Errors
    ///
    /// The same as for [`Self::zero_at`], and if the Hall signal is at an end of its range.
    pub fn zero_from_hall(&mut self) -> Result<(), ZeroError> {
        match self.seen {
            Some(seen) if !hall::plausible(seen.hall_adc) => Err(ZeroError::HallSignal),
            _ => self.zero_at(self.hall_rad),
        }
    }

    /// Sets the reference: rad in position mode, N m at the motor in torque mode. A running excitation ends.
    ///
    /// # Errors
    ///
    /// [`ReferenceError`] while disarmed, or for a value that is not finite or exceeds the limit of the mode.
    pub fn set_reference(&mut self, reference: f32) -> Result<(), ReferenceError> {
        let bound = self.reference_bound().ok_or(ReferenceError::Disarmed)?;
        if reference.is_nan() || reference.abs() > bound {
            return Err(ReferenceError::OutOfRange);
        }
        self.reference = reference;
        self.stop();
        Ok(())
    }

    /// Largest reference of the mode, in its unit. `None` while disarmed.
    fn reference_bound(&self) -> Option<f32> {
        match self.mode {
            Mode::Off | Mode::Idle => None,
            Mode::Torque => Some(self.torque_limit_nm),
            Mode::Position => Some(self.limits.travel_rad()),
        }
    }

    /// Starts an excitation at the next position tick. It is added to the reference. A step in position mode also starts the
    /// step metrics.
    ///
    /// # Errors
    ///
    /// [`ExcitationError`] while disarmed, for invalid parameters, or if the signal exceeds the limit of the mode.
    /// [`ExcitationError`] while disarmed, for numbers that make no signal, or for one beyond the limit of the mode.
    pub fn start(&mut self, excitation: &Excitation) -> Result<(), ExcitationError> {
        let bound = self.reference_bound().ok_or(ExcitationError::Disarmed)?;
        let generator = Generator::new(excitation, self.position_tick_s)?;
        if (self.reference + excitation.offset).abs() + excitation.amplitude.abs() > bound {
            return Err(ExcitationError::OutOfRange);
        }
        self.look_ahead();
        self.breakaway = None;
        self.generator = Some(generator);
        self.excite();
        if excitation.shape == Shape::Step && self.mode == Mode::Position {
            let target_rad = self.reference + excitation.offset + excitation.amplitude;
            self.metrics = Some(StepMetrics::start(
                self.setpoint,
                target_rad,
                self.band_rad,
                self.position_tick_s,
            ));
        }
        Ok(())
    }

    /// Stops a running excitation. The setpoint returns to the reference.
    pub fn stop(&mut self) {
        self.generator = None;
        self.excitation = 0.0;
    }

    /// Changes the settings without a jump of the torque, see [`Pid::retune`].
    pub fn apply(&mut self, settings: &Settings) {
        self.retune(Tuning::new(settings, self.rate));
    }

    /// The same as [`Self::apply`] with a precomputed tuning.
    pub fn retune(&mut self, tuning: Tuning) {
        if tuning.sensor != self.sensor {
            self.sensor = tuning.sensor;
            self.primed = false;
        }
        self.encoder.retune(tuning.rad_per_count);
        self.hall = tuning.hall;
        if let Some(seen) = self.seen {
            self.hall_rad = self.hall.position_rad(seen.hall_adc);
        }
        self.filter.retune(tuning.filter, self.position_rad);
        self.velocity.retune(tuning.velocity);
        self.acceleration_per_nm = tuning.acceleration_per_nm;
        self.pid.retune(tuning.pid);
        self.compensation = tuning.compensation;
        self.current_loop.retune(tuning.current);
        self.limits = tuning.limits;
        self.monitor.retune(tuning.monitor);
        self.torque_limit_nm = tuning.torque_limit_nm;
        self.torque_nm = limit(self.torque_nm, self.torque_limit_nm);
        self.band_rad = tuning.band_rad;
    }

    /// Takes readings of the current converter with the bridge off as its offset.
    ///
    /// # Errors
    ///
    /// [`OffsetError`] if the readings cannot be those of an idle bridge.
    pub fn calibrate_current_offset(&mut self, idle: &IdleReading) -> Result<(), OffsetError> {
        self.current_sensor.calibrate(idle)
    }

    /// A snapshot of the state, for display and logging.
    pub fn status(&self) -> Status {
        Status {
            mode: self.mode,
            fault: self.fault,
            zeroed: self.zeroed,
            position_rad: self.position_rad,
            hall_rad: self.hall_rad,
            velocity_rad_s: self.velocity_rad_s(),
            setpoint_rad: self.setpoint_rad(),
            torque_nm: self.torque_nm,
            current_a: self.current_a,
            metrics: self.metrics(),
            breakaway: self.breakaway,
        }
    }

    /// The telemetry sample of this control period.
    #[inline]
    pub fn sample(&self) -> Sample {
        Sample {
            setpoint: self.setpoint,
            encoder_rad: self.encoder_rad,
            hall_rad: self.hall_rad,
            velocity_rad_s: self.velocity.velocity_rad_s(),
            torque_nm: self.torque_nm,
            current_a: self.current_a,
            duty: self.duty,
            mode: self.mode as u8,
            fault: self.fault.map_or(0, |fault| fault as u8 + 1),
        }
    }

    /// Operating mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Returns true if the zero of the encoder is set.
    pub fn zeroed(&self) -> bool {
        self.zeroed
    }

    /// Returns true if an excitation runs.
    pub fn excited(&self) -> bool {
        self.generator.is_some()
    }

    /// Filtered position that the regulator uses, rad.
    pub fn position_rad(&self) -> f32 {
        self.position_rad
    }

    /// Unfiltered position of the encoder, rad.
    pub fn encoder_rad(&self) -> f32 {
        self.encoder_rad
    }

    /// Unfiltered position of the Hall sensor, rad.
    pub fn hall_rad(&self) -> f32 {
        self.hall_rad
    }

    /// Velocity of the paddle, rad/s.
    pub fn velocity_rad_s(&self) -> f32 {
        self.velocity.velocity_rad_s()
    }

    /// Last result of the Hall converter. 0 before the first measurement.
    pub fn hall_adc(&self) -> u16 {
        self.seen.map_or(0, |seen| seen.hall_adc)
    }

    /// Offset of the current amplifier, A, relative to half scale.
    pub fn current_offset_a(&self) -> f32 {
        self.current_sensor.offset_a()
    }

    /// Length of a control period, s.
    pub fn tick_s(&self) -> f32 {
        self.rate.tick_s()
    }

    /// Motor current, A. A positive current gives a positive torque.
    pub fn current_a(&self) -> f32 {
        self.current_a
    }

    /// Setpoint in position mode, rad. 0 in other modes.
    pub fn setpoint_rad(&self) -> f32 {
        if self.mode == Mode::Position {
            self.setpoint
        } else {
            0.0
        }
    }

    /// Torque command of the current loop after the limit, N m at the motor.
    pub fn torque_command_nm(&self) -> f32 {
        self.torque_nm
    }

    /// Metrics of the last step response, if there was one.
    pub fn metrics(&self) -> Option<StepReport> {
        self.metrics.as_ref().map(StepMetrics::report)
    }

    /// Value of the last ramp at which the paddle started to move, in the unit of the mode.
    pub fn breakaway(&self) -> Option<f32> {
        self.breakaway
    }
}
