//! Position regulator: PID.

use super::anti_windup::integrate;
use crate::estimate::low_pass::{self, LowPass};
use crate::settings::PidSettings;
use crate::units::DEG_PER_RAD;

/// Without integral action, a torque offset absorbed at a change of gains decays with this time constant.
const BUMP_DECAY_S: f32 = 0.1;
/// Absorbed torque offsets below this are set to zero, N m.
const BUMP_NEGLIGIBLE_NM: f32 = 1e-9;

/// PID gains per tick and per radian, as torque at the motor.
#[derive(Clone, Copy, Debug)]
pub struct PidGains {
    proportional: f32,
    integral_per_tick: f32,
    derivative_ticks: f32,
    setpoint_weight: f32,
    rate_filter: f32,
    bump_kept: f32,
    limit_nm: f32,
    /// Period of a tick, s, if the derivative uses the velocity of the observer.
    observed_tick_s: Option<f32>,
}

impl PidGains {
    /// Converts gains in N m per degree at the paddle to gains in N m per radian at the motor.
    ///
    /// `ratio` is the number of motor turns per paddle turn. `limit_nm` is the largest torque at the motor.
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

    /// The same gains with the derivative from the velocity of the observer, for ticks of `tick_s`.
    pub fn observed(self, tick_s: f32) -> Self {
        Self {
            observed_tick_s: Some(tick_s),
            ..self
        }
    }
}

/// PID regulator with setpoint weight, derivative on the measurement, and conditional integration.
///
/// `u = kp (b r - y) + I - kd d/dt LP(y)`. I is updated in each tick before it is used, see [`integrate`]. With b = 1 and no
/// derivative filter this is the control law of the lab, except that a setpoint step gives no derivative kick.
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

    /// Resets the state. The paddle stands at `position_rad`, which is also its setpoint.
    pub fn reset(&mut self, position_rad: f32) {
        self.rate.reset(0.0);
        self.weighted_error_rad = (self.gains.setpoint_weight - 1.0) * position_rad;
        self.previous_rad = position_rad;
        self.integral_nm = 0.0;
        self.bump_nm = 0.0;
    }

    /// Changes the gains without a jump of the torque.
    ///
    /// The jump that the new gains would cause is added to the integral. Without integral action (ki = 0) it would stay
    /// there permanently. In that case it decays, together with the old integral, with a time constant of 0.1 s.
    pub fn retune(&mut self, gains: PidGains) {
        let before_nm = self.proportional_derivative();
        self.gains = gains;
        self.rate.retune(gains.rate_filter);
        self.absorb(before_nm);
    }

    /// Sets the measured position to `position_rad` without a jump of the torque. It is used when the measurement jumps
    /// although the paddle did not move, for example at a change of the sensor.
    pub fn rebase(&mut self, position_rad: f32) {
        let before_nm = self.proportional_derivative();
        self.weighted_error_rad += self.previous_rad - position_rad;
        self.previous_rad = position_rad;
        self.absorb(before_nm);
    }

    /// Compensates the change of the proportional and derivative terms since they were `before_nm`.
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

    /// Computes one tick. Returns the torque at the motor, N m, within the limit.
    ///
    /// `velocity_rad_s` is that of the observer. `feed_forward_nm` is added before the limit, so that the integral takes the
    /// saturation of the sum into account.
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
