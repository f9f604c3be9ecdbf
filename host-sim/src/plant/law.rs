//! A torque that is given as a law of the motion and the input instead of being built into the plant.

use std::fmt::Debug;
use std::sync::Arc;

/// The quantities on which a law may depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Position, rad or the recording's unit.
    pub position: f64,
    /// Velocity, that unit a second.
    pub velocity: f64,
    /// The acting input: the torque of the drive over its ratio.
    pub input: f64,
    /// Time of the session, s.
    pub time_s: f64,
}

/// A torque as a function of a moment and of parameters.
pub trait TorqueLaw: Debug + Send + Sync {
    /// The torque, N m. A value that is not finite counts as 0.
    fn torque_nm(&self, at: &Moment, parameters: &[f64]) -> f64;

    /// The law as text. Two laws with the same text are equal.
    fn text(&self) -> String;
}

impl<T: TorqueLaw + ?Sized> TorqueLaw for &T {
    fn torque_nm(&self, at: &Moment, parameters: &[f64]) -> f64 {
        (**self).torque_nm(at, parameters)
    }

    fn text(&self) -> String {
        (**self).text()
    }
}

/// A law with its parameters. The plant evaluates it in the middle of each step and holds its torque over the step.
#[derive(Clone, Debug)]
pub struct Law {
    law: Arc<dyn TorqueLaw>,
    parameters: Vec<f64>,
    /// Torque of the drive per unit of input.
    ratio: f64,
}

impl Law {
    /// A law on a device whose drive has this `ratio`, N m per unit of input.
    pub fn new(law: Arc<dyn TorqueLaw>, parameters: Vec<f64>, ratio: f64) -> Self {
        Self {
            law,
            parameters,
            ratio,
        }
    }

    /// Multiplies the drive's ratio.
    pub(crate) fn scale_ratio(&mut self, factor: f64) {
        self.ratio *= factor;
    }

    /// Torque at this motion and drive torque, N m.
    pub fn torque_nm(&self, position: f64, velocity: f64, drive_nm: f64, time_s: f64) -> f64 {
        let at = Moment {
            position,
            velocity,
            input: if self.ratio == 0.0 {
                0.0
            } else {
                drive_nm / self.ratio
            },
            time_s,
        };
        let torque_nm = self.law.torque_nm(&at, &self.parameters);
        if torque_nm.is_finite() {
            torque_nm
        } else {
            0.0
        }
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        self.law.text() == other.law.text()
            && self.parameters == other.parameters
            && self.ratio == other.ratio
    }
}
