//! The relay of Åström and Hägglund (Automatica 20, 1984, p. 645): a torque of one size that always points to the reference
//! lets the paddle swing with the ultimate period, and the swing's size gives the ultimate gain.
//!
//! The relay is the position loop itself, with the largest proportional gain and a small limit of the torque, so that its
//! filter and its delays count as they will.

use core::f32::consts::PI;
use core::fmt;

use super::{Finding, Outcome, ProcedureError};
use crate::console::Device;
use crate::decimal::{Decimal, Fixed};
use crate::settings::{DerivativeSource, Settings};
use crate::units::{DEG_PER_RAD, RAD_PER_DEG};

/// Size of the relay, N m at the motor: several times the dry friction of a paddle, a sixth of the clamp.
const RELAY_NM: f32 = 0.005;
/// Gain that makes a relay of the loop, N m/deg at the paddle.
const RELAY_GAIN: f32 = 2.0;
/// The paddle is never let beyond this, degrees either side; the swing itself ends earlier.
const LIMIT_DEG: f32 = 25.0;
const WIDEST_RAD: f32 = 15.0 * RAD_PER_DEG;
/// It begins with a push from here to 0.
const PUSH_RAD: f32 = 2.0 * RAD_PER_DEG;
const PUSH_S: f32 = 0.05;
/// Half periods that are passed over, and that count.
const PASSED: u32 = 10;
const COUNTED: u32 = 40;
/// Half periods that differ by more than this share of their mean are no oscillation that lasts.
const LARGEST_SPREAD: f32 = 0.25;
/// Longest time for these, s.
const PATIENCE_S: f32 = 20.0;

/// Settings for the relay.
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

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelayFinding {
    /// N m/deg at the paddle.
    pub ultimate_gain: f32,
    /// s.
    pub ultimate_period_s: f32,
    /// Half of the swing from end to end, rad.
    pub amplitude_rad: f32,
}

impl RelayFinding {
    /// Gains of Ziegler and Nichols in the settings' units: proportional, integral, derivative.
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

/// At work.
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
    /// With these settings of the user.
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
                // Refused only when a fault has just disarmed, which the console then says.
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

/// Mean and deviation of what is added.
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
