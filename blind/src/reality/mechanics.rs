//! Inertias, gravity, springs, stops and the transmission.

use recording::Model;

use super::Motion;

/// A one-sided spring and damper beyond `at`, in the direction of `side` (+1 or -1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    pub at: f64,
    pub side: f64,
    pub stiffness: f64,
    pub damping: f64,
}

impl Stop {
    /// Torque of the stop. It pushes and never pulls.
    pub fn torque(&self, motion: Motion) -> f64 {
        let depth = self.side * (motion.x - self.at);
        if depth <= 0.0 {
            return 0.0;
        }
        -self.side * (self.stiffness * depth + self.damping * self.side * motion.v).max(0.0)
    }
}

/// A side of the transmission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Motor,
    Load,
}

/// A compliant transmission: backlash of `half_gap` (0 for none) in series with a spring and a damper.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coupling {
    pub half_gap: f64,
    pub stiffness: f64,
    pub damping: f64,
    /// Inertia on the motor side over the whole inertia.
    pub motor_share: f64,
    /// Friction on the motor side over the whole friction.
    pub motor_friction: f64,
    pub sensor: Side,
}

impl Coupling {
    /// Torque from the motor side on the load side.
    pub fn torque(&self, motor: Motion, load: Motion) -> f64 {
        let twist = motor.x - load.x;
        let wind = twist - twist.clamp(-self.half_gap, self.half_gap);
        if self.half_gap > 0.0 && wind == 0.0 {
            return 0.0;
        }
        let torque = self.stiffness * wind + self.damping * (motor.v - load.v);
        // With backlash, a flank can push but not pull.
        if self.half_gap > 0.0 && torque * wind < 0.0 {
            0.0
        } else {
            torque
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Mechanics {
    /// Sum of motor and load inertia.
    pub inertia: f64,
    pub gravity: f64,
    pub gravity_zero: f64,
    pub stiffness: f64,
    pub stiffness_zero: f64,
    /// Relative increase of the spring torque per squared unit of deflection.
    pub hardening: f64,
    pub stops: Vec<Stop>,
    pub coupling: Option<Coupling>,
}

impl Mechanics {
    pub fn plain(model: &Model) -> Self {
        let stop = |at, side| Stop {
            at,
            side,
            stiffness: model.stop_stiffness,
            damping: model.stop_damping,
        };
        Self {
            inertia: model.inertia,
            gravity: model.gravity,
            gravity_zero: model.gravity_zero,
            stiffness: model.stiffness,
            stiffness_zero: model.stiffness_zero,
            hardening: 0.0,
            stops: model.travel.map_or(Vec::new(), |[low, high]| {
                vec![stop(low, -1.0), stop(high, 1.0)]
            }),
            coupling: None,
        }
    }

    /// Torque of gravity, spring and stops. The base is tilted by `tilt_rad`.
    pub fn torque(&self, motion: Motion, tilt_rad: f64) -> f64 {
        let stretch = motion.x - self.stiffness_zero;
        let mut torque = -self.stiffness * stretch * (1.0 + self.hardening * stretch * stretch);
        if self.gravity != 0.0 {
            torque -= self.gravity * (motion.x - self.gravity_zero - tilt_rad).sin();
        }
        torque
            + self
                .stops
                .iter()
                .map(|stop| stop.torque(motion))
                .sum::<f64>()
    }
}
