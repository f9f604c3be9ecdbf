//! A whole device: drive, mechanics and position sensing, each with what is known of it.

use crate::drive::Drive;
use crate::plant::{Barrier, Friction, Mechanics};
use crate::sensing::Sensing;
use recording::Model;

const LOWER_STOP: usize = 0;
const UPPER_STOP: usize = 1;
/// Place among the barriers of what is outside the device.
pub(crate) const CONTACT: usize = 2;

/// From input to position reading, noise and quantising apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    /// From input to torque.
    pub drive: Drive,
    /// From torque to position.
    pub mechanics: Mechanics,
    /// From position to reading.
    pub sensing: Sensing,
    /// Side of the transmission on which the position sensor sits, should the transmission not be
    /// rigid.
    pub sensor_on_load: bool,
}

impl Device {
    /// Exactly what a recording's nominal model says.
    pub fn nominal(model: &Model) -> Self {
        let mut device = Self {
            drive: Drive {
                limit: model.input_limit.unwrap_or(f64::INFINITY),
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

    /// Puts hard stops at the ends of `travel`, in place of any before but one that is there already.
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
                during_s: None,
            });
        }
    }
}
