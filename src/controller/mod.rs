//! The whole way of the data in one `step`: measurement in, duty out.

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

/// What the board reads in one control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Counter of the encoder; it wraps.
    pub encoder_count: u32,
    /// Hall converter, 12 bit.
    pub hall_adc: u16,
    /// Current converter, counts, mean over the period.
    pub current_adc: f32,
}

/// Share of the supply on the motor, -0.95 to 0.95; positive turns the paddle the positive way.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Duty(pub f32);

impl Duty {
    /// No voltage.
    pub const ZERO: Self = Self(0.0);

    /// Compare value that makes this duty with a timer that counts from 0 to `top` and back, where half of it is no
    /// voltage.
    #[inline]
    pub fn compare(self, top: u16) -> u16 {
        const ROUND: f32 = 0.5;
        let half = 0.5 * f32::from(top);
        // By way of 32 bits, which is what an FPU converts to.
        (half + half * self.0 + ROUND) as u32 as u16
    }

    /// The duty that [`Self::compare`] makes of it.
    pub fn stepped(self, top: u16) -> Self {
        let half = 0.5 * f32::from(top);
        Self((f32::from(self.compare(top)) - half) / half)
    }
}

/// What the controller does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Nothing: duty 0.
    #[default]
    Off,
    /// Bridge on at no voltage, which brakes: the current's offset is read.
    Idle,
    /// Open loop: the reference is a torque, N m at the motor.
    Torque,
    /// Position loop: the reference is an angle, rad at the paddle.
    Position,
}

/// Who stopped an armed paddle at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCause {
    /// Ctrl-C on the serial port.
    Typed,
    /// The button on the board.
    Button,
}

/// The state of the controller at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// What it does.
    pub mode: Mode,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// Whether the encoder has a zero.
    pub zeroed: bool,
    /// Position that the regulator sees, filtered, rad.
    pub position_rad: f32,
    /// Position by the Hall sensor, unfiltered, rad.
    pub hall_rad: f32,
    /// Velocity of the paddle, rad/s.
    pub velocity_rad_s: f32,
    /// Setpoint in position mode, rad.
    pub setpoint_rad: f32,
    /// Torque wanted, N m at the motor.
    pub torque_nm: f32,
    /// Motor current, A.
    pub current_a: f32,
    /// Figures of the last step.
    pub metrics: Option<StepReport>,
    /// Value of the last ramp at breakaway, in the unit of its mode.
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
    /// Position ticks since boot.
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
    /// Share of the generator in the setpoint at the next position tick.
    excitation: f32,
    /// Whether [`Self::look_ahead`] has yet to follow the last position tick.
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
    /// A disarmed controller with these settings at this rate.
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

    /// One control period: all that the control interrupt calls.
    #[inline]
    pub fn step(&mut self, measurement: &Measurement) -> Duty {
        if !current::plausible(measurement.current_adc) && !self.bears(measurement.current_adc) {
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

    /// Whether control goes on with a current's reading at an end of its range: disarmed it does, unless it is no number.
    #[cold]
    #[inline(never)]
    fn bears(&mut self, mean_counts: f32) -> bool {
        if !mean_counts.is_finite() {
            self.report_fault(Fault::NonFinite);
            return false;
        }
        if self.mode != Mode::Off {
            self.report_fault(Fault::CurrentSignal);
        }
        self.mode == Mode::Off
    }

    /// What shows over a millisecond.
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

    /// Sensing, estimate and torque: once every divider ticks.
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

    /// Angle by the sensor that feeds the regulator, rad.
    #[inline]
    fn measured_rad(&self) -> f32 {
        match self.sensor {
            Sensor::Encoder => self.encoder_rad,
            Sensor::Hall => self.hall_rad,
        }
    }

    /// What no torque waits for: metrics of the last position tick, and the excitation of the next. Done in the tick
    /// before that one, so that no tick has everything to do.
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

    /// Takes the next value of the excitation, and ends it after the last.
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
        // A measurement that is no finite number leaves none of the velocity.
        if !velocity_rad_s.is_finite() {
            self.primed = false;
            return Some(Fault::NonFinite);
        }
        if !hall::plausible(measurement.hall_adc) && (self.sensor == Sensor::Hall || !self.zeroed) {
            return Some(Fault::HallSignal);
        }
        // An encoder without zero says nothing about where the paddle is.
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

    /// Puts the estimators at rest at the measured angle, as at the start, after a zero or a change of sensor.
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

    /// Starts to control. In position mode the reference is where the paddle stands, in torque mode 0.
    ///
    /// # Errors
    /// [`ArmError`] if a fault is latched, the bridge reports one, nothing was measured yet, it is armed already, or,
    /// for position mode, the encoder has no zero.
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

    /// Turns the bridge on at no voltage, on the way to `mode`.
    ///
    /// # Errors
    /// As [`Self::arm`] into that mode.
    pub fn prepare(&mut self, mode: Mode) -> Result<(), ArmError> {
        if mode == Mode::Position && !self.zeroed && self.fault.is_none() {
            return Err(ArmError::NotZeroed);
        }
        self.arm(Mode::Idle)
    }

    /// Arms torque mode for the wiring check.
    ///
    /// # Errors
    /// As [`Self::arm`].
    pub fn arm_for_check(&mut self) -> Result<(), ArmError> {
        self.arm(Mode::Torque)?;
        self.monitor.ignore_encoder();
        Ok(())
    }

    /// Begins a new reading of the current at no voltage.
    pub fn restart_idle(&mut self) {
        self.idle = IdleReading::default();
    }

    /// The reading of the current at no voltage so far.
    pub fn idle(&self) -> &IdleReading {
        &self.idle
    }

    /// Takes the reading at no voltage as the current's offset.
    ///
    /// # Errors
    /// [`OffsetError`] if that cannot be an idle bridge.
    pub fn take_offset(&mut self) -> Result<(), OffsetError> {
        self.current_sensor.calibrate(&self.idle)
    }

    /// Stops at once because somebody asks for it: as [`Self::disarm`], and remembered until it has been said.
    #[cold]
    #[inline(never)]
    pub fn stop_at_once(&mut self, cause: StopCause) {
        if self.mode != Mode::Off {
            self.stopped = Some(cause);
        }
        self.disarm();
    }

    /// Who stopped it, once.
    pub fn take_stopped(&mut self) -> Option<StopCause> {
        self.stopped.take()
    }

    /// Whether the bridge reports no fault. Disarmed that is a state, as without its supply; armed it is a fault.
    #[inline]
    pub fn set_bridge_ready(&mut self, ready: bool) {
        self.bridge_ready = ready;
        if !ready && self.mode != Mode::Off {
            self.report_fault(Fault::Bridge);
        }
    }

    /// Whether the bridge reports no fault.
    pub fn bridge_ready(&self) -> bool {
        self.bridge_ready
    }

    /// Counts that a limit acted.
    pub fn count(&mut self, acted: Acted) {
        self.counters.count(acted);
    }

    /// How often limits acted.
    pub fn counters(&self) -> Counters {
        let (torque, duty) = self.monitor.limited();
        self.counters
            .with(Acted::TorqueLimit, torque)
            .with(Acted::DutyLimit, duty)
    }

    /// Goes on from the faults of before the reset.
    pub fn recall(&mut self, faults: FaultLog) {
        self.faults = faults;
        self.faults.clear();
    }

    /// The last faults, first cause first.
    pub fn faults(&self) -> &FaultLog {
        &self.faults
    }

    /// Resistance of the winding by what it did since it was armed, ohm.
    pub fn resistance_ohm(&self) -> Option<f32> {
        self.monitor.resistance_ohm()
    }

    /// Stops: duty 0 from the next step on.
    pub fn disarm(&mut self) {
        self.mode = Mode::Off;
        self.stop();
        self.reference = 0.0;
        self.torque_nm = 0.0;
        self.duty = 0.0;
    }

    /// Stops because of a fault, which stays until [`Self::clear_fault`]; the first fault is the one kept.
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

    /// Forgets the fault. A latched fault always means disarmed, and this does not arm.
    pub fn clear_fault(&mut self) {
        self.fault = None;
        self.faults.clear();
    }

    /// Declares that the paddle stands at `angle_rad`: the zero of the encoder.
    ///
    /// # Errors
    /// [`ZeroError`] while armed, before anything was measured, or for an angle that is no number within the travel.
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

    /// Zero of the encoder by the Hall sensor's calibration.
    ///
    /// # Errors
    /// As [`Self::zero_at`], and for a Hall signal at the end of its range.
    pub fn zero_from_hall(&mut self) -> Result<(), ZeroError> {
        match self.seen {
            Some(seen) if !hall::plausible(seen.hall_adc) => Err(ZeroError::HallSignal),
            _ => self.zero_at(self.hall_rad),
        }
    }

    /// Sets the reference: rad in position mode, N m at the motor in torque mode. A running excitation ends.
    ///
    /// # Errors
    /// [`ReferenceError`] while disarmed, or for a value that is not finite or beyond the limit of the mode.
    pub fn set_reference(&mut self, reference: f32) -> Result<(), ReferenceError> {
        let bound = self.reference_bound().ok_or(ReferenceError::Disarmed)?;
        if reference.is_nan() || reference.abs() > bound {
            return Err(ReferenceError::OutOfRange);
        }
        self.reference = reference;
        self.stop();
        Ok(())
    }

    /// Largest reference of the mode, in its unit; `None` while disarmed.
    fn reference_bound(&self) -> Option<f32> {
        match self.mode {
            Mode::Off | Mode::Idle => None,
            Mode::Torque => Some(self.torque_limit_nm),
            Mode::Position => Some(self.limits.travel_rad()),
        }
    }

    /// Starts an excitation on top of the reference, at the next position tick. A step in position mode also starts
    /// the step metrics.
    ///
    /// # Errors
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

    /// Ends a running excitation; the setpoint returns to the reference.
    pub fn stop(&mut self) {
        self.generator = None;
        self.excitation = 0.0;
    }

    /// Takes over settings without a jump of the torque; see [`Pid::retune`].
    pub fn apply(&mut self, settings: &Settings) {
        self.retune(Tuning::new(settings, self.rate));
    }

    /// As [`Self::apply`], with the arithmetic already done.
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
    /// [`OffsetError`] if that cannot be an idle bridge.
    pub fn calibrate_current_offset(&mut self, idle: &IdleReading) -> Result<(), OffsetError> {
        self.current_sensor.calibrate(idle)
    }

    /// Everything below at once, for display and logging.
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

    /// What telemetry sees of this control period.
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

    /// What the controller does.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Whether the encoder has a zero.
    pub fn zeroed(&self) -> bool {
        self.zeroed
    }

    /// Whether an excitation runs.
    pub fn excited(&self) -> bool {
        self.generator.is_some()
    }

    /// Position that the regulator sees, filtered, rad.
    pub fn position_rad(&self) -> f32 {
        self.position_rad
    }

    /// Position by the encoder, unfiltered, rad.
    pub fn encoder_rad(&self) -> f32 {
        self.encoder_rad
    }

    /// Position by the Hall sensor, unfiltered, rad.
    pub fn hall_rad(&self) -> f32 {
        self.hall_rad
    }

    /// Velocity of the paddle, rad/s.
    pub fn velocity_rad_s(&self) -> f32 {
        self.velocity.velocity_rad_s()
    }

    /// What the Hall sensor's converter read last; 0 before anything was measured.
    pub fn hall_adc(&self) -> u16 {
        self.seen.map_or(0, |seen| seen.hall_adc)
    }

    /// Reading of the current's amplifier at no current, A, against half scale.
    pub fn current_offset_a(&self) -> f32 {
        self.current_sensor.offset_a()
    }

    /// A control period, s.
    pub fn tick_s(&self) -> f32 {
        self.rate.tick_s()
    }

    /// Motor current, A, positive where the torque is.
    pub fn current_a(&self) -> f32 {
        self.current_a
    }

    /// Setpoint in position mode, rad; 0 in the other modes.
    pub fn setpoint_rad(&self) -> f32 {
        if self.mode == Mode::Position {
            self.setpoint
        } else {
            0.0
        }
    }

    /// Torque that the current loop is to make, N m at the motor, after the limit.
    pub fn torque_command_nm(&self) -> f32 {
        self.torque_nm
    }

    /// Figures of the last step, if there was one.
    pub fn metrics(&self) -> Option<StepReport> {
        self.metrics.as_ref().map(StepMetrics::report)
    }

    /// Value of the last ramp at which the paddle broke away, in the unit of the mode.
    pub fn breakaway(&self) -> Option<f32> {
        self.breakaway
    }
}
