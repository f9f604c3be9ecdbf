//! Motor electrics behind an averaged H-bridge.

use crate::plant::Torque;

/// A DC motor behind a chopping bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Resistance of the winding, ohm.
    pub resistance_ohm: f64,
    /// Inductance of the winding, H.
    pub inductance_h: f64,
    /// Torque constant, N m/A; also the back-EMF constant, V s/rad at the shaft.
    pub torque_constant_nm_per_a: f64,
    /// Supply voltage, V.
    pub supply_v: f64,
}

impl Motor {
    /// Time constant of the winding, s.
    pub fn time_constant_s(&self) -> f64 {
        self.inductance_h / self.resistance_ohm
    }
}

/// State of the winding: `L i' = duty · supply − R i − K_t ω`.
///
/// The duty is constant over a tick. The speed ω of the shaft is assumed to change linearly within a tick. The current then
/// relaxes exponentially to a target with a constant rate. The change of the speed in the next tick is predicted from the
/// last tick and the change of torque. When the true change is known, the current is corrected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    motor: Motor,
    /// Acceleration of the shaft per torque of the motor, rad/s² per N m.
    acceleration_per_nm: f64,
    /// Torque at standstill per volt, N m/V.
    nm_per_volt: f64,
    lag_s: f64,
    /// Length of a tick, s.
    /// Decay of the current over a tick without voltage.
    tick_s: f64,
    decay: f64,
    /// Present torque, N m.
    torque_nm: f64,
    /// Mean torque and acceleration of the last tick, N m and rad/s².
    last: (f64, f64),
}

impl Winding {
    pub(crate) fn without_current(motor: Motor, acceleration_per_nm: f64, tick_s: f64) -> Self {
        let lag_s = motor.time_constant_s();
        Self {
            acceleration_per_nm,
            nm_per_volt: motor.torque_constant_nm_per_a / motor.resistance_ohm,
            lag_s,
            tick_s,
            decay: (-tick_s / lag_s).exp(),
            motor,
            torque_nm: 0.0,
            last: (0.0, 0.0),
        }
    }

    /// Opens the circuit. The current falls to zero at once.
    pub(crate) fn open(&mut self) {
        self.torque_nm = 0.0;
        self.last = (0.0, 0.0);
    }

    /// Torque on the shaft during the next tick with a constant `duty`, starting at the shaft's speed.
    #[inline]
    pub(crate) fn torque(&self, duty: f64, shaft_rad_s: f64) -> Torque {
        let (last_mean_nm, last_acceleration) = self.last;
        let guess = self.relaxing(duty, shaft_rad_s, last_acceleration);
        let more_nm = guess.end_and_mean(self.tick_s, self.decay).1 - last_mean_nm;
        let acceleration = last_acceleration + self.acceleration_per_nm * more_nm;
        self.relaxing(duty, shaft_rad_s, acceleration)
    }

    #[inline]
    fn relaxing(&self, duty: f64, shaft_rad_s: f64, shaft_rad_s2: f64) -> Torque {
        let volt_s = self.motor.torque_constant_nm_per_a;
        Torque {
            start_nm: self.torque_nm,
            target_nm: self.nm_per_volt * (duty * self.motor.supply_v - volt_s * shaft_rad_s),
            target_rate_nm_s: -self.nm_per_volt * volt_s * shaft_rad_s2,
            lag_s: self.lag_s,
        }
    }

    /// Advances the current by one tick, in which the speed of the shaft changed from the first to the second value. Returns
    /// the mean current, A.
    #[inline]
    pub(crate) fn advance(&mut self, duty: f64, shaft_rad_s: [f64; 2]) -> f64 {
        let acceleration = (shaft_rad_s[1] - shaft_rad_s[0]) / self.tick_s;
        let torque = self.relaxing(duty, shaft_rad_s[0], acceleration);
        let (end_nm, mean_nm) = torque.end_and_mean(self.tick_s, self.decay);
        self.last = (mean_nm, acceleration);
        self.torque_nm = end_nm;
        mean_nm / self.motor.torque_constant_nm_per_a
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn a_blocked_winding_relaxes_to_ohms_law() {
        let motor = presets::motor();
        let mut winding = Winding::without_current(motor, 0.0, motor.time_constant_s());
        let mean_a = winding.advance(0.5, [0.0; 2]);
        let settled_a = 12.0 / 10.6;
        let e = (-1.0f64).exp();
        let current_a = winding.torque_nm / motor.torque_constant_nm_per_a;
        assert!((current_a - settled_a * (1.0 - e)).abs() < 1e-12);
        // Mean of 1 − exp(−t/τ) over one time constant.
        assert!((mean_a - settled_a * e).abs() < 1e-12);
    }

    #[test]
    fn at_its_no_load_speed_it_draws_nothing() {
        let motor = presets::motor();
        let mut winding = Winding::without_current(motor, 0.0, 1e-3);
        let no_load = 0.5 * motor.supply_v / motor.torque_constant_nm_per_a;
        assert!(winding.advance(0.5, [no_load; 2]).abs() < 1e-12);
    }
}
