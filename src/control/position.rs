//! Position regulator: PID.

use super::anti_windup::integrate;
use crate::estimate::low_pass::{self, LowPass};
use crate::settings::PidSettings;
use crate::units::DEG_PER_RAD;

/// Time constant with which a jump absorbed by a change of gains decays where no integral action holds it.
const BUMP_DECAY_S: f32 = 0.1;
/// Below this torque, N m, an absorbed jump is over.
const BUMP_NEGLIGIBLE_NM: f32 = 1e-9;

/// Gains per tick and per radian, torque at the motor.
#[derive(Clone, Copy, Debug)]
pub struct PidGains {
    proportional: f32,
    integral_per_tick: f32,
    derivative_ticks: f32,
    setpoint_weight: f32,
    rate_filter: f32,
    bump_kept: f32,
    limit_nm: f32,
    /// A tick, s, if the derivative is the observer's.
    observed_tick_s: Option<f32>,
}

impl PidGains {
    /// From gains in N m per degree at the paddle to gains in N m per radian at the motor.
    ///
    /// `ratio` is the motor's turns per turn of the paddle, `limit_nm` the largest torque at the motor.
    pub fn new(settings: &PidSettings, ratio: f32, limit_nm: f32, tick_s: f32) -> Self {
        let per_rad_at_motor = DEG_PER_RAD / ratio;
        Self {
            proportional: settings.kp_nm_per_deg * per_rad_at_motor,
            integral_per_tick: settings.ki_nm_per_deg_s * per_rad_at_motor * tick_s,
            derivative_ticks: settings.kd_nm_s_per_deg * per_rad_at_motor / tick_s,
            setpoint_weight: settings.setpoint_weight,
            rate_filter: low_pass::gain(settings.derivative_cutoff_hz, tick_s),
            bump_kept: 1.0 - (tick_s / BUMP_DECAY_S).min(1.0),
            limit_nm,
            observed_tick_s: None,
        }
    }

    /// The same, with the derivative taken from the observer's velocity, at ticks of `tick_s`.
    pub fn observed(self, tick_s: f32) -> Self {
        Self {
            observed_tick_s: Some(tick_s),
            ..self
        }
    }
}

/// PID with setpoint weight, derivative on the measurement, and conditional integration.
///
/// `u = kp (b r - y) + I - kd d/dt LP(y)`, with I summed each tick before it is used, see [`integrate`]. With b = 1 and
/// no derivative filter this is the lab's law, except that a setpoint step gives no derivative kick.
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    gains: PidGains,
    rate: LowPass,
    weighted_error_rad: f32,
    previous_rad: f32,
    integral_nm: f32,
    bump_nm: f32,
}

impl Pid {
    /// A regulator at rest at 0.
    pub fn new(gains: PidGains) -> Self {
        Self {
            gains,
            rate: LowPass::new(gains.rate_filter),
            weighted_error_rad: 0.0,
            previous_rad: 0.0,
            integral_nm: 0.0,
            bump_nm: 0.0,
        }
    }

    /// Forgets the past; the paddle stands at `position_rad` and is meant to.
    pub fn reset(&mut self, position_rad: f32) {
        self.rate.reset(0.0);
        self.weighted_error_rad = (self.gains.setpoint_weight - 1.0) * position_rad;
        self.previous_rad = position_rad;
        self.integral_nm = 0.0;
        self.bump_nm = 0.0;
    }

    /// Takes over gains without a jump of the torque.
    ///
    /// The jump that the new gains would make is put into the integral term. Without integral action (ki = 0) it
    /// would stay there for ever, so then it, and what the integral held, decays with a time constant of 0.1 s.
    pub fn retune(&mut self, gains: PidGains) {
        let before_nm = self.proportional_derivative();
        self.gains = gains;
        self.rate.retune(gains.rate_filter);
        self.absorb(before_nm);
    }

    /// The measured position jumps to `position_rad` although the paddle did not move, as when the sensor changes:
    /// neither does the torque jump.
    pub fn rebase(&mut self, position_rad: f32) {
        let before_nm = self.proportional_derivative();
        self.weighted_error_rad += self.previous_rad - position_rad;
        self.previous_rad = position_rad;
        self.absorb(before_nm);
    }

    /// Makes up for a jump of the proportional and derivative terms from `before_nm`.
    fn absorb(&mut self, before_nm: f32) {
        let held_nm =
            self.integral_nm + self.bump_nm + (before_nm - self.proportional_derivative());
        (self.integral_nm, self.bump_nm) = if self.gains.integral_per_tick == 0.0 {
            (0.0, held_nm)
        } else {
            (held_nm, 0.0)
        };
    }

    #[inline]
    fn proportional_derivative(&self) -> f32 {
        self.gains.proportional * self.weighted_error_rad
            - self.gains.derivative_ticks * self.rate.output()
    }

    /// One tick: torque at the motor, N m, within the limit.
    ///
    /// `velocity_rad_s` is the observer's. `feed_forward_nm` is added before the limit, so that the integral knows when the sum saturates.
    #[inline]
    pub fn update(
        &mut self,
        setpoint_rad: f32,
        position_rad: f32,
        velocity_rad_s: f32,
        feed_forward_nm: f32,
    ) -> f32 {
        self.rate.update(match self.gains.observed_tick_s {
            None => position_rad - self.previous_rad,
            Some(tick_s) => velocity_rad_s * tick_s,
        });
        self.previous_rad = position_rad;
        self.weighted_error_rad = self.gains.setpoint_weight * setpoint_rad - position_rad;

        if self.bump_nm != 0.0 {
            self.bump_nm *= self.gains.bump_kept;
            if self.bump_nm.abs() < BUMP_NEGLIGIBLE_NM {
                self.bump_nm = 0.0;
            }
        }

        let held_nm =
            self.proportional_derivative() + self.bump_nm + feed_forward_nm + self.integral_nm;
        let step_nm = self.gains.integral_per_tick * (setpoint_rad - position_rad);
        integrate(&mut self.integral_nm, held_nm, step_nm, self.gains.limit_nm)
    }

    /// The integral term, N m at the motor.
    pub fn integral_nm(&self) -> f32 {
        self.integral_nm
    }
}
