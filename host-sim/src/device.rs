//! A complete device: drive, mechanics and position sensing.

use crate::drive::Drive;
use crate::plant::{Barrier, Friction, Mechanics, error_deadband};
use crate::sensing::Sensing;
use recording::Model;

const LOWER_STOP: usize = 0;
const UPPER_STOP: usize = 1;
/// Index of the first barrier that is an external contact. The stops come before it.
pub(crate) const CONTACT: usize = 2;
pub(crate) const PUSH: usize = 6;

/// Least inertia of a device, as a share of the stated one.
const LEAST_INERTIA: f64 = 0.01;

/// A simulated device. It turns an input into a position reading without noise and quantisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    /// Turns the input into torque.
    pub drive: Drive,
    /// Turns torque into motion.
    pub mechanics: Mechanics,
    /// Turns the position into a reading.
    pub sensing: Sensing,
    /// True if the position sensor is on the load side of a compliant transmission.
    pub sensor_on_load: bool,
}

impl Device {
    /// The device that the nominal model of a recording describes.
    pub fn nominal(model: &Model) -> Self {
        let mut device = Self {
            drive: Drive {
                limit: model.input_limit.unwrap_or(f64::INFINITY),
                rate_limit: model.input_rate_limit.unwrap_or(f64::INFINITY),
                delay_s: model.delay,
                lag_s: model.lag,
                ..Drive::ideal(model.ratio)
            },
            mechanics: Mechanics {
                viscous: model.viscous,
                gravity: model.gravity,
                gravity_zero: model.gravity_zero,
                angle_rad: model.angle_rad,
                stiffness: model.stiffness,
                stiffness_zero: model.stiffness_zero,
                offset_nm: model.offset,
                friction: Friction::coulomb(model.coulomb),
                laws: error_deadband(model).into_iter().collect(),
                ..Mechanics::inertia(model.inertia)
            },
            sensing: Sensing::ideal(),
            sensor_on_load: false,
        };
        if let Some(travel) = model.travel {
            device.set_stops(travel, model.stop_stiffness, model.stop_damping);
        }
        device
    }

    /// The device with another load. `stated` is the nominal model of the recording, and `own` that of a run with the load.
    /// Each number of the device changes by the difference of the two models. The ratio changes by their quotient.
    pub fn with_load(&self, stated: &Model, own: &Model) -> Self {
        let mut device = self.clone();
        let drive = &mut device.drive;
        let ratio = own.ratio / stated.ratio;
        drive.ratio *= ratio;
        drive.delay_s = (drive.delay_s + own.delay - stated.delay).max(0.0);
        drive.lag_s = (drive.lag_s + own.lag - stated.lag).max(0.0);
        if own.input_limit != stated.input_limit {
            drive.limit = own.input_limit.unwrap_or(f64::INFINITY);
        }
        if own.input_rate_limit != stated.input_rate_limit {
            drive.rate_limit = own.input_rate_limit.unwrap_or(f64::INFINITY);
        }
        let mechanics = &mut device.mechanics;
        let inertia = mechanics.inertia + own.inertia - stated.inertia;
        mechanics.inertia = inertia.max(LEAST_INERTIA * own.inertia);
        mechanics.viscous += own.viscous - stated.viscous;
        mechanics.gravity += own.gravity - stated.gravity;
        mechanics.gravity_zero += own.gravity_zero - stated.gravity_zero;
        mechanics.stiffness += own.stiffness - stated.stiffness;
        mechanics.stiffness_zero += own.stiffness_zero - stated.stiffness_zero;
        mechanics.offset_nm += own.offset - stated.offset;
        let friction = &mut mechanics.friction;
        friction.level_nm = friction
            .level_nm
            .map(|level| (level + own.coulomb - stated.coulomb).max(0.0));
        // The dead band with the stated numbers is replaced by the one with the numbers of the run.
        let stated_deadband = error_deadband(stated);
        mechanics
            .laws
            .retain(|law| stated_deadband.as_ref() != Some(law));
        mechanics
            .laws
            .iter_mut()
            .for_each(|law| law.scale_ratio(ratio));
        mechanics.laws.extend(error_deadband(own));
        for stop in mechanics.barriers[..CONTACT].iter_mut().flatten() {
            stop.stiffness += own.stop_stiffness - stated.stop_stiffness;
            stop.damping += own.stop_damping - stated.stop_damping;
        }
        device
    }

    /// Sets hard stops at the ends of `travel`. An existing stop at the same position is kept, others are replaced.
    pub fn set_stops(&mut self, travel: [f64; 2], stiffness: f64, damping: f64) {
        for (place, at, side) in [(LOWER_STOP, travel[0], -1.0), (UPPER_STOP, travel[1], 1.0)] {
            if self.mechanics.barriers[place].is_some_and(|stop| stop.at == at) {
                continue;
            }
            self.mechanics.barriers[place] = Some(Barrier {
                at,
                side,
                stiffness,
                damping,
                torque_nm: 0.0,
                during_s: None,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paddle() -> Model {
        Model {
            coulomb: 0.01,
            ratio: 2.0,
            ..Model::new(2e-4)
        }
    }

    #[test]
    fn the_nominal_device_with_a_load_equals_the_nominal_device_of_the_loaded_model() {
        let loaded = Model {
            inertia: 5e-4,
            gravity: 0.1,
            gravity_zero: 0.2,
            coulomb: 0.004,
            delay: 1e-3,
            input_limit: Some(3.0),
            stiffness: 0.5,
            error_deadband: Some(0.01),
            ..paddle()
        };
        let device = Device::nominal(&paddle()).with_load(&paddle(), &loaded);
        assert_eq!(device, Device::nominal(&loaded));
    }

    #[test]
    fn effects_beyond_the_model_are_kept_with_any_load() {
        let mut device = Device::nominal(&paddle());
        device.mechanics.inertia = 3e-4;
        device.mechanics.viscous = 1e-3;
        let loaded = Model {
            inertia: 6e-4,
            ..paddle()
        };
        let device = device.with_load(&paddle(), &loaded);
        let inertia = device.mechanics.inertia;
        assert!((inertia - 7e-4).abs() < 1e-12, "{inertia}");
        assert_eq!(device.mechanics.viscous, 1e-3);
    }
}
