//! The relay experiment of Åström and Hägglund (Automatica 20, 1984, p. 645). A torque of constant magnitude that always
//! points to the reference makes the paddle oscillate with the ultimate period. The amplitude gives the ultimate gain.
//!
//! The relay is the position loop itself, with the largest proportional gain and a small torque limit. The result therefore
//! includes the loop's filter and delays.

use core::f32::consts::PI;
use core::fmt;

use super::{Finding, Outcome, ProcedureError};
use crate::console::Device;
use crate::decimal::{Decimal, Fixed};
use crate::settings::{DerivativeSource, Settings};
use crate::units::{DEG_PER_RAD, RAD_PER_DEG};

/// Torque of the relay, N m at the motor: several times the dry friction of a paddle, a sixth of the motor's torque limit.
const RELAY_NM: f32 = 0.005;
/// Proportional gain that makes the loop act as a relay, N m/deg at the paddle.
const RELAY_GAIN: f32 = 2.0;
/// Travel limit of the experiment, degrees on either side. An oscillation that is too wide ends earlier.
/// Widest allowed oscillation, rad on either side.
const LIMIT_DEG: f32 = 25.0;
const WIDEST_RAD: f32 = 15.0 * RAD_PER_DEG;
/// Initial step of the reference from here to 0, rad.
/// Duration of the initial step, s.
const PUSH_RAD: f32 = 2.0 * RAD_PER_DEG;
const PUSH_S: f32 = 0.05;
/// Number of half periods that are skipped at the beginning.
/// Number of half periods that are evaluated.
const PASSED: u32 = 10;
const COUNTED: u32 = 40;
/// Largest relative spread of the half periods of a steady oscillation.
const LARGEST_SPREAD: f32 = 0.25;
/// Time limit of the experiment, s.
const PATIENCE_S: f32 = 20.0;

/// Changes the settings for the relay.
pub fn adapt(settings: &mut Settings) {
    let pid = &mut settings.pid;
    pid.kp_nm_per_deg = RELAY_GAIN;
    pid.ki_nm_per_deg_s = 0.0;
    pid.kd_nm_s_per_deg = 0.0;
    pid.setpoint_weight = 1.0;
    pid.derivative = DerivativeSource::Position;
    settings.motor.torque_limit_nm = RELAY_NM.min(settings.motor.torque_limit_nm);
    settings.limit.travel_deg = LIMIT_DEG.min(settings.limit.travel_deg);
    settings.limit.stall_s = 0.5;
}

/// The result of the procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelayFinding {
    /// Ultimate gain, N m/deg at the paddle.
    pub ultimate_gain: f32,
    /// Ultimate period, s.
    pub ultimate_period_s: f32,
    /// Amplitude of the oscillation, rad: half the peak-to-peak value.
    pub amplitude_rad: f32,
}

impl RelayFinding {
    /// Gains of the Ziegler-Nichols rules, in the units of the settings: proportional, integral, derivative.
    pub fn gains(&self) -> [f32; 3] {
        let proportional = 0.6 * self.ultimate_gain;
        [
            proportional,
            proportional / (0.5 * self.ultimate_period_s),
            proportional * 0.125 * self.ultimate_period_s,
        ]
    }
}

impl fmt::Display for RelayFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = |value: f32| Fixed(value, 5);
        let [kp, ki, kd] = self.gains();
        write!(
            f,
            "ultimate gain {} N m/deg at the paddle, ultimate period {} ms, swing +-{} deg\r\n\
             Ziegler and Nichols: set kp {}; set ki {}; set kd {}\r\n\
             these overshoot: begin with less integral and more derivative gain",
            rounded(self.ultimate_gain),
            Fixed(self.ultimate_period_s * 1e3, 1),
            Fixed(self.amplitude_rad * DEG_PER_RAD, 2),
            rounded(kp),
            Decimal(libm::roundf(ki * 1e3) * 1e-3),
            Fixed(kd, 6)
        )
    }
}

/// The running procedure.
#[derive(Clone, Debug)]
pub struct RelayTest {
    torque_nm: f32,
    ratio: f32,
    elapsed_s: f32,
    pushed: bool,
    last_rad: f32,
    crossed_s: Option<f32>,
    peak_rad: f32,
    halves: u32,
    times_s: Mean,
    peaks_rad: Mean,
}

impl RelayTest {
    /// Starts the procedure with the user's settings.
    pub fn new(users: &Settings) -> Self {
        Self {
            torque_nm: RELAY_NM.min(users.motor.torque_limit_nm),
            ratio: users.mechanism.ratio,
            elapsed_s: 0.0,
            pushed: false,
            last_rad: 0.0,
            crossed_s: None,
            peak_rad: 0.0,
            halves: 0,
            times_s: Mean::default(),
            peaks_rad: Mean::default(),
        }
    }

    /// See [`super::Procedure::advance`].
    #[inline(never)]
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        self.elapsed_s += elapsed_s;
        let reference_rad = if self.elapsed_s < PUSH_S {
            PUSH_RAD
        } else {
            0.0
        };
        let begins =
            !self.pushed || (self.elapsed_s >= PUSH_S && self.elapsed_s - elapsed_s < PUSH_S);
        let position_rad = device.with(|c| {
            if begins {
                // The reference is refused only after a fault, which the console reports.
                let _ = c.set_reference(reference_rad);
            }
            c.position_rad()
        });
        self.pushed = true;
        if position_rad.abs() > WIDEST_RAD {
            return Some(Err(ProcedureError::TooWide));
        }
        if self.elapsed_s > PATIENCE_S {
            return Some(Err(ProcedureError::NoOscillation));
        }
        self.follow(position_rad, elapsed_s)
    }

    fn follow(&mut self, position_rad: f32, elapsed_s: f32) -> Option<Outcome> {
        let crosses = (position_rad >= 0.0) != (self.last_rad >= 0.0);
        let moved_rad = position_rad - self.last_rad;
        self.last_rad = position_rad;
        self.peak_rad = self.peak_rad.max(position_rad.abs());
        if !crosses {
            return None;
        }
        let now_s = self.elapsed_s - elapsed_s * position_rad / moved_rad;
        if let Some(before_s) = self.crossed_s.replace(now_s) {
            self.halves += 1;
            if self.halves > PASSED {
                self.times_s.add(now_s - before_s);
                self.peaks_rad.add(self.peak_rad);
            }
        }
        self.peak_rad = 0.0;
        (self.halves >= PASSED + COUNTED).then(|| self.conclude())
    }

    fn conclude(&self) -> Outcome {
        let (half_s, amplitude_rad) = (self.times_s.mean(), self.peaks_rad.mean());
        let spread = self.times_s.deviation() / half_s;
        if spread.is_nan() || spread > LARGEST_SPREAD || amplitude_rad <= 0.0 {
            return Err(ProcedureError::NoOscillation);
        }
        let torque_nm = self.torque_nm * self.ratio;
        Ok(Finding::ZieglerNichols(RelayFinding {
            ultimate_gain: 4.0 * torque_nm / (PI * amplitude_rad * DEG_PER_RAD),
            ultimate_period_s: 2.0 * half_s,
            amplitude_rad,
        }))
    }
}

/// Mean and standard deviation of the added values.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    count: f32,
    sum: f32,
    squares: f32,
}

impl Mean {
    fn add(&mut self, value: f32) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self) -> f32 {
        self.sum / self.count
    }

    fn deviation(&self) -> f32 {
        let mean = self.mean();
        libm::sqrtf((self.squares / self.count - mean * mean).max(0.0))
    }
}
