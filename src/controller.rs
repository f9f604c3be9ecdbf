//! The whole way of the data in one `step`: measurement in, duty out.

use core::fmt;

use crate::control::compensation::Compensation;
use crate::control::current::{CurrentGains, CurrentLoop};
use crate::control::position::{Pid, PidGains};
use crate::estimate::biquad::{self, SecondOrder};
use crate::estimate::low_pass::{self, LowPass};
use crate::estimate::velocity::{TrackerGains, VelocityTracker};
use crate::excitation::{Excitation, ExcitationError, Generator, Shape};
use crate::metrics::{StepMetrics, StepReport};
use crate::safety::{Fault, Limits};
use crate::sensing::current::{CurrentSensor, OffsetError};
use crate::sensing::encoder::{self, Encoder};
use crate::sensing::hall::{self, HallCurve};
use crate::settings::{FilterOrder, Sensor, Settings};
use crate::units::{RAD_PER_DEG, limit};

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

/// Share of the supply on the motor, -0.98 to 0.98; positive turns the paddle the positive way.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Duty(pub f32);

impl Duty {
    /// No voltage.
    pub const ZERO: Self = Self(0.0);
}

/// What the controller does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Nothing: duty 0.
    #[default]
    Off,
    /// Open loop: the reference is a torque, N m at the motor.
    Torque,
    /// Position loop: the reference is an angle, rad at the paddle.
    Position,
}

/// How often [`Controller::step`] is called, and how often of these the position loop runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickRate {
    tick_hz: f32,
    divider: u16,
}

impl TickRate {
    /// `tick_hz` calls of `step` a second, the position loop at every `divider`-th (0 counts as 1).
    pub const fn new(tick_hz: f32, divider: u16) -> Self {
        Self {
            tick_hz,
            divider: if divider == 0 { 1 } else { divider },
        }
    }

    /// Period of the current loop, s.
    pub fn tick_s(&self) -> f32 {
        1.0 / self.tick_hz
    }

    /// Period of the position loop, s.
    pub fn position_tick_s(&self) -> f32 {
        f32::from(self.divider) / self.tick_hz
    }
}

/// Settings made ready for one rate: all divisions and exponentials are done here, outside the control interrupt.
#[derive(Clone, Debug)]
pub struct Tuning {
    rad_per_count: f32,
    hall: HallCurve,
    sensor: Sensor,
    low_pass: f32,
    second_order: Option<idsp::iir::Biquad<f32>>,
    velocity: TrackerGains,
    pid: PidGains,
    compensation: Compensation,
    current: CurrentGains,
    limits: Limits,
    torque_limit_nm: f32,
    band_rad: f32,
}

impl Tuning {
    /// The tuning of these settings at this rate.
    pub fn new(settings: &Settings, rate: TickRate) -> Self {
        let tick_s = rate.position_tick_s();
        let ratio = settings.mechanism.ratio;
        let estimate = &settings.estimate;
        Self {
            rad_per_count: encoder::rad_per_count(settings.mechanism.counts_per_turn, ratio),
            hall: HallCurve::new(&settings.hall),
            sensor: estimate.sensor,
            low_pass: low_pass::gain(estimate.cutoff_hz, tick_s),
            second_order: match estimate.order {
                FilterOrder::First => None,
                FilterOrder::Second => Some(biquad::butterworth(estimate.cutoff_hz, tick_s)),
            },
            velocity: TrackerGains::new(estimate.velocity_bandwidth_hz, tick_s),
            pid: PidGains::new(&settings.pid, ratio, settings.motor.torque_limit_nm, tick_s),
            compensation: Compensation::new(&settings.compensation, ratio),
            current: CurrentGains::new(&settings.motor, ratio, rate.tick_s()),
            limits: Limits::new(&settings.limit, tick_s),
            torque_limit_nm: settings.motor.torque_limit_nm,
            band_rad: settings.metrics.band_deg * RAD_PER_DEG,
        }
    }
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
    low_pass: LowPass,
    second_order: Option<SecondOrder>,
    velocity: VelocityTracker,
    compensation: Compensation,
    pid: Pid,
    current_loop: CurrentLoop,
    limits: Limits,
    torque_limit_nm: f32,
    band_rad: f32,

    mode: Mode,
    fault: Option<Fault>,
    zeroed: bool,
    primed: bool,
    seen: Option<Measurement>,
    disagreed_ticks: u32,

    reference: f32,
    generator: Option<Generator>,
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
            low_pass: LowPass::new(tuning.low_pass),
            second_order: tuning.second_order.map(SecondOrder::new),
            velocity: VelocityTracker::new(tuning.velocity),
            compensation: tuning.compensation,
            pid: Pid::new(tuning.pid),
            current_loop: CurrentLoop::new(tuning.current),
            limits: tuning.limits,
            torque_limit_nm: tuning.torque_limit_nm,
            band_rad: tuning.band_rad,
            mode: Mode::Off,
            fault: None,
            zeroed: false,
            primed: false,
            seen: None,
            disagreed_ticks: 0,
            reference: 0.0,
            generator: None,
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
        if !measurement.current_adc.is_finite() {
            self.report_fault(Fault::NonFinite);
            return Duty::ZERO;
        }
        self.current_a = self.current_sensor.amperes(measurement.current_adc);

        if self.ticks_to_position == 0 {
            self.ticks_to_position = self.rate.divider;
            self.position_step(measurement);
        }
        self.ticks_to_position -= 1;

        if self.mode == Mode::Off {
            return Duty::ZERO;
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
        Duty(duty)
    }

    /// Sensing, estimate and torque: once every divider ticks.
    #[inline]
    fn position_step(&mut self, measurement: &Measurement) {
        self.seen = Some(*measurement);
        self.encoder_rad = self.encoder.position_rad(measurement.encoder_count);
        self.hall_rad = self.hall.position_rad(measurement.hall_adc);
        let measured_rad = match self.sensor {
            Sensor::Encoder => self.encoder_rad,
            Sensor::Hall => self.hall_rad,
        };
        if !self.primed {
            self.prime(measured_rad);
        }
        self.position_rad = match &mut self.second_order {
            None => self.low_pass.update(measured_rad),
            Some(filter) => filter.update(measured_rad),
        };
        let velocity_rad_s = self.velocity.update(measured_rad);

        if self.mode == Mode::Off {
            return;
        }
        if let Some(fault) = self.motion_fault(measurement, measured_rad, velocity_rad_s) {
            self.report_fault(fault);
            return;
        }
        let previous_setpoint = self.setpoint;
        self.setpoint = self.reference + self.excite();
        let torque_nm = match self.mode {
            Mode::Off => 0.0,
            Mode::Torque => {
                let compensation_nm =
                    self.compensation
                        .torque_nm(self.position_rad, velocity_rad_s, velocity_rad_s);
                limit(self.setpoint + compensation_nm, self.torque_limit_nm)
            }
            Mode::Position => {
                if let Some(metrics) = &mut self.metrics {
                    metrics.update(self.position_rad);
                }
                let setpoint_velocity = (self.setpoint - previous_setpoint) * self.position_rate_hz;
                let compensation_nm = self.compensation.torque_nm(
                    self.position_rad,
                    velocity_rad_s,
                    setpoint_velocity,
                );
                self.pid
                    .update(self.setpoint, self.position_rad, compensation_nm)
            }
        };
        if torque_nm.is_finite() {
            self.torque_nm = torque_nm;
        } else {
            self.report_fault(Fault::NonFinite);
        }
    }

    #[inline]
    fn motion_fault(
        &mut self,
        measurement: &Measurement,
        measured_rad: f32,
        velocity_rad_s: f32,
    ) -> Option<Fault> {
        if !(measured_rad.is_finite() && velocity_rad_s.is_finite()) {
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

    /// The excitation's share of the setpoint at this tick.
    #[inline]
    fn excite(&mut self) -> f32 {
        let Some(generator) = &mut self.generator else {
            return 0.0;
        };
        match generator.next(self.position_rad) {
            Some(value) => value,
            None => {
                self.breakaway = generator.breakaway();
                self.generator = None;
                0.0
            }
        }
    }

    /// Puts the estimators at rest at the measured angle.
    fn prime(&mut self, measured_rad: f32) {
        self.primed = true;
        self.low_pass.reset(measured_rad);
        if let Some(filter) = &mut self.second_order {
            filter.reset(measured_rad);
        }
        self.velocity.reset(measured_rad);
        self.position_rad = measured_rad;
        self.pid.reset(measured_rad);
    }

    /// Starts to control. In position mode the reference is where the paddle stands, in torque mode 0.
    ///
    /// # Errors
    /// [`ArmError`] if a fault is latched, nothing was measured yet, it is armed already, or, for position mode,
    /// the encoder has no zero.
    pub fn arm(&mut self, mode: Mode) -> Result<(), ArmError> {
        if let Some(fault) = self.fault {
            return Err(ArmError::Faulted(fault));
        }
        if mode == Mode::Off {
            self.disarm();
            return Ok(());
        }
        if self.mode != Mode::Off {
            return Err(ArmError::AlreadyArmed);
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
        self.mode = mode;
        Ok(())
    }

    /// Stops: duty 0 from the next step on.
    pub fn disarm(&mut self) {
        self.mode = Mode::Off;
        self.generator = None;
        self.reference = 0.0;
        self.torque_nm = 0.0;
    }

    /// Stops because of a fault, which stays until [`Self::clear_fault`]; the first fault is the one kept.
    pub fn report_fault(&mut self, fault: Fault) {
        self.fault.get_or_insert(fault);
        self.disarm();
    }

    /// Forgets the fault. A latched fault always means disarmed, and this does not arm.
    pub fn clear_fault(&mut self) {
        self.fault = None;
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
        let bound = match self.mode {
            Mode::Off => return Err(ReferenceError::Disarmed),
            Mode::Torque => self.torque_limit_nm,
            Mode::Position => self.limits.travel_rad(),
        };
        if reference.is_nan() || reference.abs() > bound {
            return Err(ReferenceError::OutOfRange);
        }
        self.reference = reference;
        self.generator = None;
        Ok(())
    }

    /// Starts an excitation on top of the reference, at the next position tick. A step in position mode also starts
    /// the step metrics.
    ///
    /// # Errors
    /// [`ExcitationError`] while disarmed, or for numbers that make no signal.
    pub fn start(&mut self, excitation: &Excitation) -> Result<(), ExcitationError> {
        if self.mode == Mode::Off {
            return Err(ExcitationError::Disarmed);
        }
        self.generator = Some(Generator::new(excitation, self.position_tick_s)?);
        self.breakaway = None;
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
        self.low_pass.retune(tuning.low_pass);
        let position_rad = self.position_rad;
        self.second_order = tuning.second_order.map(|section| {
            let mut filter = SecondOrder::new(section);
            filter.reset(position_rad);
            filter
        });
        if self.second_order.is_none() {
            self.low_pass.reset(position_rad);
        }
        self.velocity.retune(tuning.velocity);
        self.pid.retune(tuning.pid);
        self.compensation = tuning.compensation;
        self.current_loop.retune(tuning.current);
        self.limits = tuning.limits;
        self.torque_limit_nm = tuning.torque_limit_nm;
        self.band_rad = tuning.band_rad;
    }

    /// Takes the mean reading of the current converter, counts, with the bridge idle, as its offset.
    ///
    /// # Errors
    /// [`OffsetError`] if that cannot be an idle bridge.
    pub fn calibrate_current_offset(&mut self, idle_counts: f32) -> Result<(), OffsetError> {
        self.current_sensor.calibrate(idle_counts)
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

/// Why arming is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmError {
    /// This fault is latched.
    Faulted(Fault),
    /// Armed already.
    AlreadyArmed,
    /// No measurement has arrived.
    NothingMeasured,
    /// The encoder has no zero.
    NotZeroed,
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faulted(fault) => write!(f, "fault latched, mend and clear it: {fault}"),
            Self::AlreadyArmed => f.write_str("armed already: disarm first"),
            Self::NothingMeasured => {
                f.write_str("nothing measured yet: is the control loop running?")
            }
            Self::NotZeroed => f.write_str("the encoder has no zero: use zero, or zero hall"),
        }
    }
}

impl core::error::Error for ArmError {}

/// Why a zero is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroError {
    /// The controller is armed.
    Armed,
    /// No measurement has arrived.
    NothingMeasured,
    /// The angle is not within the travel.
    OutsideTravel,
    /// The Hall sensor's converter is at an end of its range.
    HallSignal,
}

impl fmt::Display for ZeroError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Armed => "disarm before zeroing",
            Self::NothingMeasured => "nothing measured yet: is the control loop running?",
            Self::OutsideTravel => "the angle is outside limit.travel",
            Self::HallSignal => {
                "Hall signal at the end of its range: check its wire, or zero by hand"
            }
        })
    }
}

impl core::error::Error for ZeroError {}

/// Why a reference is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceError {
    /// The controller is off.
    Disarmed,
    /// Beyond the travel or the torque limit, or not a number.
    OutOfRange,
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Disarmed => "arm before setting a reference",
            Self::OutOfRange => "the reference is beyond limit.travel or motor.torque_limit",
        })
    }
}

impl core::error::Error for ReferenceError {}
