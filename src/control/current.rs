//! Current regulator of the motor: PI control with feed-forward.

use core::f32::consts::TAU;

use super::anti_windup::integrate;
use crate::scalar::flushed;
use crate::settings::MotorSettings;

/// Largest duty. Above it the bootstrap capacitors of the bridge are not recharged. Each bridge input is low for (1 - 0.95)
/// / 2 of a PWM period, which is 625 ns at 40 kHz. The lab's limit of 0.98 gives 333 ns at its 30 kHz.
pub const MAX_DUTY: f32 = 0.95;

/// Largest loop gain per tick. With one tick of delay, 1/4 is critically damped.
const MAX_CORRECTION_PER_TICK: f32 = 0.25;

/// Gains per tick, from A to duty.
#[derive(Clone, Copy, Debug)]
pub struct CurrentGains {
    pole: f32,
    proportional: f32,
    integral_per_tick: f32,
    resistance: f32,
    back_emf_s_rad: f32,
    amperes_per_nm: f32,
}

impl CurrentGains {
    /// PI gains that cancel the pole of the winding with zero-order hold. With a = exp(-R T / L) the winding is (1 - a) / R
    /// / (z - a). The regulator K (z - a) / (z - 1) leaves a pure integrator with the gain g = 2 pi f T.
    ///
    /// `ratio` is the number of motor turns per paddle turn.
    pub fn new(settings: &MotorSettings, ratio: f32, tick_s: f32) -> Self {
        let pole = libm::expf(-settings.resistance_ohm * tick_s / settings.inductance_h);
        let correction =
            (TAU * settings.current_bandwidth_hz * tick_s).min(MAX_CORRECTION_PER_TICK);
        let gain = correction * settings.resistance_ohm / (1.0 - pole);
        let per_volt = 1.0 / settings.supply_v;
        Self {
            pole,
            proportional: gain * pole * per_volt,
            integral_per_tick: gain * (1.0 - pole) * per_volt,
            resistance: settings.resistance_ohm * per_volt,
            back_emf_s_rad: settings.torque_constant_nm_per_a * ratio * per_volt,
            amperes_per_nm: 1.0 / settings.torque_constant_nm_per_a,
        }
    }
}

/// A regulator with two degrees of freedom. The feed-forward produces the current. The PI part corrects the difference
/// between the measured current and the current that the feed-forward should have produced so far.
///
/// If the PI part used the plain error, it would integrate while the winding still follows the feed-forward, and the current
/// would overshoot.
#[derive(Clone, Copy, Debug)]
pub struct CurrentLoop {
    gains: CurrentGains,
    integral: f32,
    acting_a: f32,
    pending_a: f32,
    expected_a: f32,
}

impl CurrentLoop {
    /// A regulator at rest.
    pub fn new(gains: CurrentGains) -> Self {
        Self {
            gains,
            integral: 0.0,
            acting_a: 0.0,
            pending_a: 0.0,
            expected_a: 0.0,
        }
    }

    /// Changes the gains. The integral, which is a duty, is kept.
    pub fn retune(&mut self, gains: CurrentGains) {
        self.gains = gains;
    }

    /// Resets the state to zero current.
    #[inline]
    pub fn reset(&mut self) {
        *self = Self::new(self.gains);
    }

    /// Computes one tick. Returns the duty within [`MAX_DUTY`]. Inputs are the commanded torque at the motor (N m), the
    /// measured current (A, mean over the last period) and the velocity of the paddle (rad/s).
    ///
    /// The feed-forward is the voltage across the resistance plus the back-EMF.
    #[inline]
    pub fn update(&mut self, torque_nm: f32, current_a: f32, velocity_rad_s: f32) -> f32 {
        let wanted_a = torque_nm * self.gains.amperes_per_nm;
        // A duty acts during the whole period after the next update, so its mean current is measured two ticks from now.
        let before_a = self.expected_a;
        self.expected_a = flushed(self.acting_a + (before_a - self.acting_a) * self.gains.pole);
        self.acting_a = self.pending_a;
        self.pending_a = wanted_a;
        let error_a = 0.5 * (before_a + self.expected_a) - current_a;

        let held = self.gains.resistance * wanted_a
            + self.gains.back_emf_s_rad * velocity_rad_s
            + self.gains.proportional * error_a
            + self.integral;
        let step = self.gains.integral_per_tick * error_a;
        integrate(&mut self.integral, held, step, MAX_DUTY)
    }
}
