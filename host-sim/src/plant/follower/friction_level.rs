//! Dry friction of one side while it slides in one direction, if its level does not depend on position or speed.

use super::super::Plant;
use super::super::drift::Drifting;

pub(super) struct FrictionLevel {
    /// Level without drift, N m, positive against positive motion.
    settled_nm: f64,
    drifting: Option<Drifting>,
}

impl FrictionLevel {
    /// The level, 0 if it depends on position or speed.
    pub(super) fn of(plant: &Plant, side: usize, direction: f64, time_s: f64) -> Self {
        let is_level = plant.is_level && direction != 0.0;
        let drift = plant.mechanics.friction.drift.filter(|_| is_level);
        Self {
            settled_nm: if is_level {
                plant.level_nm(side, direction)
            } else {
                0.0
            },
            drifting: drift.map(|drift| Drifting::from(drift, time_s)),
        }
    }

    /// Level at a time, N m.
    #[inline]
    pub(super) fn at(&mut self, time_s: f64) -> f64 {
        match &mut self.drifting {
            Some(drifting) => self.settled_nm * drifting.factor(time_s),
            None => self.settled_nm,
        }
    }
}
