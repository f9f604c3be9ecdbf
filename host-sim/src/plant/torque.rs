//! The torque that drives the joint over one step.

/// Joint torque over one step: held, or relaxing exponentially as behind a first-order lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// At the start of the step, N m.
    pub start_nm: f64,
    /// What it relaxes to, N m.
    pub target_nm: f64,
    /// Time constant of the relaxation, s; 0 = at the target at once.
    pub lag_s: f64,
}

impl Torque {
    /// A constant torque.
    pub fn held(torque_nm: f64) -> Self {
        Self {
            start_nm: torque_nm,
            target_nm: torque_nm,
            lag_s: 0.0,
        }
    }

    /// True if it does not change.
    #[inline]
    pub fn is_held(&self) -> bool {
        self.lag_s == 0.0 || self.start_nm == self.target_nm
    }

    /// Torque `t_s` after the start of the step, N m.
    #[inline]
    pub fn at(&self, t_s: f64) -> f64 {
        if !self.is_held() {
            self.target_nm + (self.start_nm - self.target_nm) * (-t_s / self.lag_s).exp()
        } else {
            self.target_nm
        }
    }

    /// What is left of this torque after `t_s`.
    #[inline]
    pub fn after(&self, t_s: f64) -> Self {
        Self {
            start_nm: self.at(t_s),
            ..*self
        }
    }

    /// The longest step that follows the relaxation, s: a fourth-order step over half a time
    /// constant misses 1e-5 of it.
    pub(super) fn longest_step(&self) -> f64 {
        if !self.is_held() {
            0.5 * self.lag_s
        } else {
            f64::INFINITY
        }
    }
}
