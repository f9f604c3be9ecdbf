//! Motor electrics behind an averaged H-bridge.

use crate::plant::Torque;

/// A DC motor on the supply that its bridge chops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Of the winding, ohm.
    pub resistance_ohm: f64,
    /// Of the winding, H.
    pub inductance_h: f64,
    /// N m/A, and V s/rad of the shaft.
    pub torque_constant_nm_per_a: f64,
    /// V.
    pub supply_v: f64,
}

impl Motor {
    /// Time constant of the winding, s.
    pub fn time_constant_s(&self) -> f64 {
        self.inductance_h / self.resistance_ohm
    }
}

/// The winding at work.
///
/// `L i' = duty · supply − R i − K_t ω`. The duty is held over a tick and the shaft's speed ω changes little within
/// one, so that the current relaxes exponentially.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    motor: Motor,
    current_a: f64,
}

impl Winding {
    pub(crate) fn without_current(motor: Motor) -> Self {
        Self {
            motor,
            current_a: 0.0,
        }
    }

    /// Torque on the shaft while the bridge holds `duty` and the shaft turns at `shaft_rad_s`.
    #[inline]
    pub(crate) fn torque(&self, duty: f64, shaft_rad_s: f64) -> Torque {
        let motor = &self.motor;
        let volts = duty * motor.supply_v - motor.torque_constant_nm_per_a * shaft_rad_s;
        Torque {
            start_nm: motor.torque_constant_nm_per_a * self.current_a,
            target_nm: motor.torque_constant_nm_per_a * volts / motor.resistance_ohm,
            lag_s: motor.time_constant_s(),
        }
    }

    /// Carries the current over `dt_s` of what [`Self::torque`] gave; its mean over that time, A.
    #[inline]
    pub(crate) fn advance(&mut self, torque: Torque, dt_s: f64) -> f64 {
        let per_nm = 1.0 / self.motor.torque_constant_nm_per_a;
        let settled_a = torque.target_nm * per_nm;
        let before_a = self.current_a;
        self.current_a = torque.at(dt_s) * per_nm;
        settled_a + (before_a - self.current_a) * torque.lag_s / dt_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn a_blocked_winding_relaxes_to_ohms_law() {
        let motor = presets::motor();
        let mut winding = Winding::without_current(motor);
        let tau_s = motor.time_constant_s();
        let mean_a = winding.advance(winding.torque(0.5, 0.0), tau_s);
        let settled_a = 12.0 / 10.6;
        let e = (-1.0f64).exp();
        assert!((winding.current_a - settled_a * (1.0 - e)).abs() < 1e-12);
        // Mean of 1 − exp(−t/τ) over one time constant.
        assert!((mean_a - settled_a * e).abs() < 1e-12);
    }

    #[test]
    fn at_its_no_load_speed_it_draws_nothing() {
        let motor = presets::motor();
        let winding = Winding::without_current(motor);
        let no_load = 0.5 * motor.supply_v / motor.torque_constant_nm_per_a;
        assert!(winding.torque(0.5, no_load).target_nm.abs() < 1e-15);
    }
}
